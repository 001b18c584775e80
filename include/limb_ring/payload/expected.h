#pragma once

#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include "limb_ring/payload/errors.h"

namespace limb_ring::payload {

/// A value, or why there is none. Nothing here throws on bytes from outside.
template <typename T, typename E>
class Expected {
 public:
  Expected(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  Expected(E error) : content_(std::in_place_index<1>, std::move(error)) {}

  explicit operator bool() const { return content_.index() == 0; }
  /// @pre holds a value
  const T& operator*() const { return *std::get_if<0>(&content_); }
  T& operator*() { return *std::get_if<0>(&content_); }
  const T* operator->() const { return std::get_if<0>(&content_); }
  /// @pre holds no value
  const E& error() const { return *std::get_if<1>(&content_); }

 private:
  std::variant<T, E> content_;
};

template <typename T>
using Decoded = Expected<T, DecodeError>;
using Encoded = Expected<std::vector<std::uint8_t>, EncodeFailure>;

}  // namespace limb_ring::payload
