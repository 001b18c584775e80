#include "core/transmit/flight.h"

namespace limb_ring::core {

std::uint8_t* Flight::load(wire::Code code, wire::NodeId source, wire::NodeId destination, std::uint8_t last,
                           std::size_t data_size) {
  code_ = code;
  size_ = data_size + wire::kOverhead;
  (*bytes_)[wire::field::kSop] = wire::kSop;
  (*bytes_)[wire::field::kHop] = 0;
  (*bytes_)[wire::field::kSource] = source;
  std::uint8_t* end = bytes_->data() + size_;
  *(end - wire::field::kEopFromEnd) = wire::kEop;
  *(end - wire::field::kFbcFromEnd) = wire::kFbcUntaken;
  *(end - wire::field::kDestinationFromEnd) = destination;
  *(end - wire::field::kLastFromEnd) = last;
  return bytes_->data() + wire::kHeaderSize;
}

wire::ByteView Flight::launch(Time now, Duration timeout) {
  (*bytes_)[wire::field::kCode] = code_.byte();
  const std::size_t covered = size_ - wire::kCrcSize;
  wire::store_u32(bytes_->data() + covered, wire::crc32({bytes_->data(), covered}));
  phase_ = Phase::out;
  since_ = sent_at_ = now;
  deadline_ = now + timeout;
  return image();
}

bool Flight::is_return(const wire::PacketFields& packet) const {
  const wire::PacketFields sent{image()};
  if (idle() || packet.bytes.size != size_ || packet.code_byte() != sent.code_byte()) return false;
  const std::uint32_t as_sent = wire::carried_crc(packet.crc(), size_, packet.hop(), packet.fbc() ^ wire::kFbcUntaken);
  return packet.destination() == sent.destination() && packet.last() == sent.last() && as_sent == sent.crc();
}

bool Flight::retry(Time now) {
  if (code_.attempt == wire::kTries - 1) return false;
  ++code_.attempt;
  phase_ = Phase::waiting;
  since_ = now;
  return true;
}

}  // namespace limb_ring::core
