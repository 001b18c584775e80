#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "limb_ring/payload/byte_view.h"

namespace limb_ring::python {

namespace py = pybind11;

void bind_messages(py::module& module);
void bind_payload(py::module& module);
void bind_port(py::module& module);
void bind_joint_node(py::module& module);

inline py::bytes to_bytes(const std::vector<std::uint8_t>& data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}

/// Bytes of Python's: valid as long as `text` is.
inline payload::ByteView view(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

inline double seconds(std::chrono::nanoseconds time) { return std::chrono::duration<double>(time).count(); }

}  // namespace limb_ring::python
