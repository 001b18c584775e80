#include "limb_ring/payload/errors.h"

namespace limb_ring::payload {

const char* to_string(DecodeError error) {
  switch (error) {
    case DecodeError::truncated:
      return "ends before its last field";
    case DecodeError::trailing_bytes:
      return "goes on after its last field";
    case DecodeError::wrong_type:
      return "is of another type";
    case DecodeError::wrong_version:
      return "is of a version not known here";
    case DecodeError::bad_count:
      return "has a number of items that the format does not allow";
    case DecodeError::bad_field:
      return "has a field with a value that means nothing";
  }
  return "unknown error";
}

static const char* sentence(EncodeError error) {
  switch (error) {
    case EncodeError::not_a_number:
      return "is not a number";
    case EncodeError::too_many_items:
      return "does not fit into one packet of 512 bytes any more";
    case EncodeError::too_large:
      return "is longer than the format allows";
    case EncodeError::bad_field:
      return "has a value that the format cannot express";
  }
  return "unknown error";
}

std::string to_string(const EncodeFailure& failure) {
  return "item " + std::to_string(failure.item) + ": " + sentence(failure.error);
}

}  // namespace limb_ring::payload
