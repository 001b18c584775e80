#include "wire/checksum.h"

#include <isa-l/crc.h>

#include <array>

namespace limb_ring::wire {
namespace {

#if defined(__x86_64__)
// ISA-L's AVX-512 path leaves the upper vector halves dirty, which makes the SSE code after it
// several times slower.
__attribute__((target("avx"))) void clear_upper_halves() { __builtin_ia32_vzeroupper(); }
const bool has_avx = __builtin_cpu_supports("avx");
void after_isal() {
  if (has_avx) clear_upper_halves();
}
#else
void after_isal() {}
#endif

constexpr std::size_t kMaxBytesAfter = 520;
/// change[n][b]: what bit b of a byte that n bytes follow does to the CRC.
using ChangeTable = std::array<std::array<std::uint32_t, 8>, kMaxBytesAfter + 1>;

constexpr std::uint32_t kPolynomial = 0xEDB88320u;

std::uint32_t shift_bits(std::uint32_t crc, int bits) {
  for (int i = 0; i < bits; ++i) crc = crc >> 1 ^ (crc & 1 ? kPolynomial : 0u);
  return crc;
}

std::uint32_t shift_bits_back(std::uint32_t crc, std::size_t bits) {
  for (std::size_t i = 0; i < bits; ++i) crc = crc >> 31 != 0 ? (crc ^ kPolynomial) << 1 | 1 : crc << 1;
  return crc;
}

ChangeTable make_change_table() {
  ChangeTable table;
  for (int bit = 0; bit < 8; ++bit) {
    std::uint32_t crc = shift_bits(1u << bit, 8);
    for (auto& row : table) {
      row[bit] = crc;
      crc = shift_bits(crc, 8);
    }
  }
  return table;
}

const ChangeTable change_table = make_change_table();

}  // namespace

std::uint32_t crc32(ByteView bytes) {
  const std::uint32_t crc = crc32_gzip_refl(0, bytes.data, bytes.size);
  after_isal();
  return crc;
}

std::uint32_t crc32_change(std::uint8_t delta, std::size_t bytes_after) {
  const auto& row = change_table[bytes_after];
  std::uint32_t change = 0;
  for (unsigned bits = delta; bits != 0; bits &= bits - 1) change ^= row[__builtin_ctz(bits)];
  return change;
}

std::uint32_t crc32_cause(std::uint32_t change, std::size_t bytes_after) {
  return shift_bits_back(change, 8 * (sizeof change + bytes_after));
}

}  // namespace limb_ring::wire
