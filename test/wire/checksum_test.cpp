#include "wire/checksum.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

namespace limb_ring::wire {
namespace {

TEST(Checksum, IsTheCrc32OfIeee8023) {
  const std::string check = "123456789";  // the check value of the CRC catalogues
  EXPECT_EQ(crc32({reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}), 0xCBF43926u);
}

TEST(Checksum, ChangeOfAnyByteAtAnyPlaceIsWhatRecomputingGives) {
  std::vector<std::uint8_t> bytes(520);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{3});
  const std::uint32_t before = crc32({bytes.data(), bytes.size()});
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (std::uint8_t delta : {0x01, 0x80, 0x07, 0xFF, 0xA5}) {
      bytes[i] ^= delta;
      EXPECT_EQ(before ^ crc32_change(delta, bytes.size() - 1 - i), crc32({bytes.data(), bytes.size()}));
      bytes[i] ^= delta;
    }
  }
}

TEST(Checksum, FourBytesGiveAnyChange) {
  std::vector<std::uint8_t> bytes(100, 0x33);
  const std::uint32_t before = crc32({bytes.data(), bytes.size()});
  for (const std::size_t after : {std::size_t{0}, std::size_t{4}, std::size_t{96}}) {
    for (const std::uint32_t change : {1u, 0x80000000u, 0x12345678u}) {
      std::vector<std::uint8_t> changed = bytes;
      const std::uint32_t cause = crc32_cause(change, after);
      for (std::size_t i = 0; i < 4; ++i)
        changed[bytes.size() - after - 4 + i] ^= static_cast<std::uint8_t>(cause >> 8 * i);
      EXPECT_EQ(before ^ change, crc32({changed.data(), changed.size()}));
    }
  }
}

TEST(Checksum, NoChangeChangesNothing) { EXPECT_EQ(crc32_change(0, 17), 0u); }

}  // namespace
}  // namespace limb_ring::wire
