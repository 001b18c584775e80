#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace limb_ring::payload {

/// Why bytes are not the format they were read as. (ours)
enum class DecodeError : std::uint8_t {
  truncated,       ///< ends before its last field
  trailing_bytes,  ///< goes on after its last field
  wrong_type,      ///< the first byte names another format
  wrong_version,   ///< a version this code does not know
  bad_count,       ///< more items, or another number of them, than the format allows
  bad_field        ///< a field holds a value that means nothing (unknown flag, negative time)
};
const char* to_string(DecodeError error);

/// Why a value cannot be written. (ours)
enum class EncodeError : std::uint8_t {
  not_a_number,    ///< a value is NaN, which no robot should obey
  too_many_items,  ///< does not fit into one packet of 512 bytes
  too_large,       ///< a text or message longer than its length field or limit
  bad_field        ///< a negative time, or something else the reader would refuse
};

/// Why a value cannot be written, and which part of it.
struct EncodeFailure {
  EncodeError error = EncodeError::bad_field;
  std::size_t item = 0;  ///< which joint or axis, from 0
};
/// A sentence for people: "item 3: is not a number".
std::string to_string(const EncodeFailure& failure);

}  // namespace limb_ring::payload
