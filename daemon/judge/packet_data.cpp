#include "judge/packet_data.h"

#include <algorithm>

namespace limb_ring::recorder {
namespace {

/// Zeroes, but for the four bytes before the trailer, which make the CRC right.
void make_up(std::uint8_t* packet, std::size_t size) {
  constexpr std::size_t kFour = sizeof(std::uint32_t);
  const std::size_t covered = size - wire::kCrcSize;
  std::uint8_t* const four = packet + covered - wire::kTrailerSize - kFour;
  std::fill(packet + wire::kHeaderSize, four + kFour, std::uint8_t{0});
  const std::uint32_t change = wire::crc32({packet, covered}) ^ wire::load_u32(packet + covered);
  const std::uint32_t bytes = wire::crc32_cause(change, wire::kTrailerSize);
  for (std::size_t i = 0; i < kFour; ++i) four[i] = static_cast<std::uint8_t>(bytes >> 8 * i);
}

}  // namespace

// As its source has sent it: on its way HOP and FBC change, and the CRC with them.
std::uint64_t key_of(const wire::PacketFields& packet) {
  const std::uint32_t crc =
      wire::carried_crc(packet.crc(), packet.bytes.size, packet.hop(), packet.fbc() ^ wire::kFbcUntaken);
  return std::uint64_t{crc} << 32 | std::uint64_t{packet.code_byte()} << 24 | std::uint64_t{packet.source()} << 16 |
         std::uint64_t{packet.destination()} << 8 | packet.last();
}

void PacketData::put(std::uint64_t key, wire::ByteView data, bool made_up) {
  const auto [place, added] = packets_.try_emplace(key);
  place->second = {{data.begin(), data.end()}, made_up};
  if (!added) return;
  order_.push_back(key);
  if (order_.size() <= kMost) return;
  packets_.erase(order_.front());
  order_.pop_front();
}

void PacketData::keep(wire::ByteView packet) {
  const wire::PacketFields fields{packet};
  put(key_of(fields), fields.data(), false);
}

bool PacketData::fill_in(std::uint8_t* packet, std::size_t size) {
  const wire::PacketFields fields{{packet, size}};
  const auto found = packets_.find(key_of(fields));
  const bool kept = found != packets_.end() && found->second.data.size() == fields.data().size;
  if (kept) {
    std::copy(found->second.data.begin(), found->second.data.end(), packet + wire::kHeaderSize);
    if (fields.crc_good()) return !found->second.made_up;
  }
  make_up(packet, size);
  put(key_of(fields), fields.data(), true);
  return false;
}

bool PacketData::is_made_up(wire::ByteView packet) const {
  const auto found = packets_.find(key_of({packet}));
  return found != packets_.end() && found->second.made_up;
}

}  // namespace limb_ring::recorder
