#include "sim/trace.h"

#include <string>

namespace limb_ring::sim {
namespace {

const char* kind_name(wire::SliceKind kind) {
  switch (kind) {
    case wire::SliceKind::start:
      return "start";
    case wire::SliceKind::more:
      return "more";
    case wire::SliceKind::end:
      return "end";
    case wire::SliceKind::whole:
      return "whole";
    case wire::SliceKind::interrupt:
      return "INTP";
    case wire::SliceKind::abort:
      return "abort";
    case wire::SliceKind::idle:
      return "idle";
    case wire::SliceKind::fold:
      return "fold";
  }
  return "";
}

/// Bijective and cheap; order matters. (the finalizer of SplitMix64)
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

}  // namespace

const char* to_string(Incident incident) {
  switch (incident) {
    case Incident::killed:
      return "killed";
    case Incident::started:
      return "started";
    case Incident::frozen:
      return "frozen";
    case Incident::thawed:
      return "thawed";
    case Incident::cut:
      return "cut";
    case Incident::healed:
      return "healed";
    case Incident::output_replaced:
      return "output replaced";
    case Incident::lost_slice:
      return "slice lost";
    case Incident::damaged_slice:
      return "slice damaged";
    case Incident::late_slice:
      return "slice late";
    case Incident::resumed:
      return "goes on";
    case Incident::cpu_reset:
      return "CPU reset";
    case Incident::cancelled:
      return "sends cancelled";
  }
  return "?";
}

std::string hash_text(std::uint64_t hash) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; hash >>= 4) text[i] = "0123456789abcdef"[hash & 15];
  return text;
}

void Trace::record(Time now, NodeId node, const char* what, std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  const auto time = static_cast<std::uint64_t>(core::picoseconds(now.time_since_epoch()));
  for (const std::uint64_t value : {time, std::uint64_t{node}, a, b, c}) hash_ = mix(hash_ ^ value) + 1;
  for (const char* letter = what; *letter; ++letter) hash_ = mix(hash_ ^ static_cast<unsigned char>(*letter));
  if (text_) *text_ << time << ' ' << unsigned{node} << ' ' << what << ' ' << a << ' ' << b << ' ' << c << '\n';
}

// The CRC over a packet with its own CRC is always the same, so the last four bytes are recorded apart.
void Trace::leaves(NodeId node, const wire::Slice& slice, Time now) {
  const wire::ByteView bytes = slice.bytes;
  if (bytes.size < 4) return record(now, node, kind_name(slice.kind), bytes.size, 0, 0);
  record(now, node, kind_name(slice.kind), bytes.size, wire::load_u32(bytes.data + bytes.size - 4),
         wire::crc32(bytes.first(bytes.size - 4)));
}

void Trace::event(NodeId node, const core::Event& event) {
  if (const auto* end = std::get_if<core::SendEnded>(&event.what))
    return record(event.at, node, "send ended", end->token, static_cast<std::uint64_t>(end->outcome),
                  static_cast<std::uint64_t>(core::picoseconds(end->round_trip)));
  if (const auto* pin = std::get_if<core::PinPulled>(&event.what))
    return record(event.at, node, "pin pulled", pin->factor, pin->source, 0);
  if (const auto* state = std::get_if<core::StateChanged>(&event.what))
    return record(event.at, node, "state", static_cast<std::uint64_t>(state->before),
                  static_cast<std::uint64_t>(state->after), 0);
  if (const auto* peer = std::get_if<core::PeerChanged>(&event.what))
    return record(event.at, node, "peer changed", peer->node, 0, 0);
  if (const auto* home = std::get_if<core::BeaconHome>(&event.what))
    record(event.at, node, "beacon home", static_cast<std::uint64_t>(core::picoseconds(home->round_trip)), 0, 0);
}

void Trace::packet(NodeId node, const core::ReceivedPacket& packet) {
  record(packet.at, node, "received", packet.source, packet.size, wire::crc32(packet.bytes()));
}

void Trace::incident(NodeId node, Incident incident, Time now, Line) {
  record(now, node, to_string(incident), 0, 0, 0);
}

}  // namespace limb_ring::sim
