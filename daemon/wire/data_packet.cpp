#include "wire/data_packet.h"

#include <cstring>

namespace limb_ring::wire {

std::size_t encode(const DataPacket& packet, std::uint8_t* out) {
  const std::uint8_t header[] = {packet.code.byte(), kSop, packet.hop, packet.source};
  const std::uint8_t trailer[] = {kEop, packet.fbc, packet.destination, packet.pri};
  std::memcpy(out, header, kHeaderSize);
  std::memcpy(out + kHeaderSize, packet.data.data, packet.data.size);
  std::memcpy(out + kHeaderSize + packet.data.size, trailer, kTrailerSize);
  const std::size_t covered = kHeaderSize + packet.data.size + kTrailerSize;
  store_u32(out + covered, crc32({out, covered}));
  return covered + kCrcSize;
}

PacketError decode(ByteView bytes, DataPacket& packet) {
  const PacketError error = check_packet(bytes, false);
  if (error != PacketError::none) return error;
  const PacketFields f{bytes};
  packet = {f.code(), f.hop(), f.source(), f.fbc(), f.destination(), f.last(), f.data()};
  return PacketError::none;
}

}  // namespace limb_ring::wire
