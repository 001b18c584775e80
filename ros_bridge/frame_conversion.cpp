#include "ros_bridge/frame_conversion.h"

#include "wire/data_packet.h"

namespace limb_ring::bridge {
namespace {

void take_trailer(const wire::PacketFields& fields, Frame& frame) {
  frame.fbc = fields.fbc();
  frame.did = fields.destination();
  if (frame.kind == Frame::INTERRUPT) {
    frame.factor = fields.last();
    return;
  }
  frame.priority = wire::priority_of(fields.last());
  frame.channel = wire::channel_of(fields.last());
  if (frame.channel == static_cast<std::uint8_t>(wire::Channel::control)) frame.kind = Frame::CONTROL;
  const wire::ByteView data = fields.data();
  frame.payload.assign(data.begin(), data.end());
}

}  // namespace

Frame to_frame(const CapturedPacket& packet, const config::NodeConfig& node, const config::RingConfig& ring) {
  const CaptureInfo& info = packet.info;
  const wire::PacketFields fields{{packet.bytes.data(), packet.bytes.size()}};
  Frame frame;
  frame.header.stamp.fromNSec(static_cast<std::uint64_t>(packet.time_ns));
  frame.node = node.name;
  frame.line_from = ring.name_of(info.from);
  frame.line_to = ring.name_of(info.to);
  frame.direction = info.input ? Frame::IN : Frame::OUT;
  frame.retry = info.retry;
  frame.own = info.own;
  frame.embedded = info.embedded;
  frame.size = static_cast<std::uint16_t>(packet.bytes.size());
  frame.span = std::chrono::duration<double>(info.span).count();
  if (packet.bytes.size() < wire::kHeaderSize) return frame;
  frame.code = fields.code_byte();
  frame.kind = fields.code().interrupt ? Frame::INTERRUPT : Frame::DATA;
  frame.attempt = fields.code().attempt;
  frame.sequence = fields.code().sequence;
  frame.hop = fields.hop();
  frame.sid = fields.source();
  frame.whole = !info.aborted && !info.truncated && packet.bytes.size() >= wire::kOverhead;
  frame.crc_ok = frame.whole && !info.crc_bad;
  if (frame.whole)
    take_trailer(fields, frame);
  else
    frame.payload.assign(packet.bytes.begin() + wire::kHeaderSize, packet.bytes.end());
  return frame;
}

}  // namespace limb_ring::bridge
