#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "limb_ring/payload/byte_view.h"

namespace limb_ring::payload {

using Bytes = std::vector<std::uint8_t>;

inline ByteView view(const Bytes& bytes) { return {bytes.data(), bytes.size()}; }

/// Every proper beginning of a good packet is refused. Each is copied to memory of just its size,
/// so that a sanitizer sees a read past the end.
template <typename Decode>
void expect_every_truncation_is_refused(const Bytes& good, Decode decode) {
  ASSERT_TRUE(decode(view(good)));
  for (std::size_t size = 0; size < good.size(); ++size) {
    const Bytes cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(decode(view(cut))) << "of " << size << " bytes";
  }
  Bytes longer = good;
  longer.push_back(0);
  EXPECT_FALSE(decode(view(longer)));
}

/// Random bytes behind a right type and version: decoded or refused, and what decodes says the
/// same again when it is written and read once more.
template <typename Decode>
void expect_random_bytes_do_no_harm(std::uint8_t type, Decode decode) {
  const std::uint32_t seed = 20240917;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes(random() % 80);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (bytes.size() > 1) bytes[0] = type;
    if (bytes.size() > 1) bytes[1] = 1;
    const auto decoded = decode(view(bytes));
    if (decoded) {
      const auto again = encode(*decoded);
      ASSERT_TRUE(again);
      ASSERT_EQ(again->size(), bytes.size());
    }
  }
}

}  // namespace limb_ring::payload
