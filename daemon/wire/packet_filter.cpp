#include "wire/packet_filter.h"

#include "wire/packet.h"

namespace limb_ring::capture {
namespace {

template <std::size_t N>
bool lets(const std::bitset<N>& wanted, std::size_t value) {
  return wanted.none() || wanted[value];
}

}  // namespace

Kind kind_of(const PacketView& packet) {
  if (packet.interrupt()) return Kind::interrupt;
  const bool control = packet.whole() && wire::is_control(wire::PacketFields{packet.bytes});
  return control ? Kind::control : Kind::data;
}

bool Filter::passes(const PacketView& packet) const {
  if (!(packet.info.input ? input : output)) return false;
  if (!lets(source, packet.source())) return false;
  return lets(kinds, static_cast<std::size_t>(kind_of(packet))) && trailer_passes(packet);
}

bool Filter::trailer_passes(const PacketView& packet) const {
  if (!packet.whole()) return destination.none() && priority.none() && channel.none();
  const wire::PacketFields fields{packet.bytes};
  if (!lets(destination, fields.destination())) return false;
  if (packet.interrupt()) return priority.none() && channel.none();
  return lets(priority, wire::priority_of(fields.last())) && lets(channel, wire::channel_of(fields.last()));
}

bool Selection::takes(const PacketView& packet) {
  ++counts_.seen;
  if (!choice_.filter.passes(packet)) {
    ++counts_.filtered;
    return false;
  }
  if (passed_++ % choice_.sample != 0) {
    ++counts_.sampled_out;
    return false;
  }
  if (within_limit(packet.at)) return true;
  ++counts_.limited;
  return false;
}

bool Selection::within_limit(std::chrono::nanoseconds at) {
  if (choice_.limit_per_s == 0) return true;
  const std::int64_t second = std::chrono::duration_cast<std::chrono::seconds>(at).count();
  if (second != second_) in_second_ = 0;
  second_ = second;
  return in_second_++ < choice_.limit_per_s;
}

}  // namespace limb_ring::capture
