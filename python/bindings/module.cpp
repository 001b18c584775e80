#include "bindings.h"

PYBIND11_MODULE(_client, module) {
  module.doc() = "The client library of limb_ring and the formats inside packets; see limb_ring.";
  limb_ring::python::bind_messages(module);
  limb_ring::python::bind_payload(module);
  limb_ring::python::bind_port(module);
  limb_ring::python::bind_joint_node(module);
}
