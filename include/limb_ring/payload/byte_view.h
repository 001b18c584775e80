#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace limb_ring::payload {

/// A run of bytes owned by someone else, who has to keep them as long as this is used. A vector of bytes, such as a
/// received packet's data, converts to one.
struct ByteView {
  ByteView() = default;
  ByteView(const std::uint8_t* first, std::size_t count) : data(first), size(count) {}
  ByteView(const std::vector<std::uint8_t>& bytes) : data(bytes.data()), size(bytes.size()) {}

  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< bytes

  const std::uint8_t* begin() const { return data; }
  const std::uint8_t* end() const { return data + size; }
  std::uint8_t operator[](std::size_t i) const { return data[i]; }
  bool empty() const { return size == 0; }
};

}  // namespace limb_ring::payload
