#include "core/transmit/flight.h"

namespace limb_ring::core {

std::uint8_t* Flight::load(wire::Code code, wire::NodeId source, wire::NodeId destination,
                           std::uint8_t last, std::size_t data_size) {
  code_ = code;
  size_ = data_size + wire::kOverhead;
  bytes_[0] = code.byte();
  bytes_[1] = wire::kSop;
  bytes_[2] = 0;
  bytes_[3] = source;
  std::uint8_t* trailer = bytes_.data() + wire::kHeaderSize + data_size;
  trailer[0] = wire::kEop;
  trailer[1] = wire::kFbcUntaken;
  trailer[2] = destination;
  trailer[3] = last;
  phase_ = Phase::waiting;
  return bytes_.data() + wire::kHeaderSize;
}

wire::ByteView Flight::launch(Time now, Duration timeout) {
  bytes_[0] = code_.byte();
  const std::size_t covered = size_ - wire::kCrcSize;
  wire::store_u32(bytes_.data() + covered, wire::crc32({bytes_.data(), covered}));
  phase_ = Phase::out;
  since_ = sent_at_ = now;
  deadline_ = now + timeout;
  return image();
}

bool Flight::is_return(const wire::PacketFields& packet) const {
  if (idle() || packet.bytes.size != size_ || packet.code_byte() != bytes_[0]) return false;
  const std::uint32_t as_sent = wire::carried_crc(packet.crc(), size_, packet.hop(),
                                                  packet.fbc() ^ wire::kFbcUntaken);
  return packet.destination() == destination() && packet.last() == bytes_[size_ - 5] &&
         as_sent == wire::load_u32(bytes_.data() + size_ - wire::kCrcSize);
}

bool Flight::retry(Time now) {
  if (code_.attempt == kMostRetries) return false;
  ++code_.attempt;
  phase_ = Phase::waiting;
  since_ = now;
  return true;
}

}  // namespace limb_ring::core
