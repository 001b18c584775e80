#include "model/packet.h"

#include <zlib.h>

namespace limb_ring::model {

std::uint32_t crc_of(const Bytes& bytes, std::size_t count) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), count));
}

std::uint32_t Packet::crc() const {
  std::uint32_t crc = 0;
  for (std::size_t i = bytes.size() - 4; i < bytes.size(); ++i) crc = crc << 8 | bytes[i];
  return crc;
}

static void store(Bytes& bytes, std::uint32_t crc) {
  for (std::size_t i = 0; i < 4; ++i) bytes[bytes.size() - 1 - i] = static_cast<std::uint8_t>(crc >> 8 * i);
}

void Packet::rewrite(int hop, int fbc) {
  const std::uint32_t wrong_by = crc() ^ crc_of(bytes, bytes.size() - 4);
  bytes[2] = static_cast<std::uint8_t>(hop);
  bytes[bytes.size() - 7] = static_cast<std::uint8_t>(fbc);
  store(bytes, crc_of(bytes, bytes.size() - 4) ^ wrong_by);
}

Packet make_packet(int code, int source, int destination, int last, const Bytes& data) {
  Packet packet;
  const auto put = [&](int byte) { packet.bytes.push_back(static_cast<std::uint8_t>(byte)); };
  for (const int byte : {code, int{kSop}, 0, source}) put(byte);
  packet.bytes.insert(packet.bytes.end(), data.begin(), data.end());
  for (const int byte : {int{kEop}, 0xFF, destination, last, 0, 0, 0, 0}) put(byte);
  store(packet.bytes, crc_of(packet.bytes, packet.bytes.size() - 4));
  return packet;
}

}  // namespace limb_ring::model
