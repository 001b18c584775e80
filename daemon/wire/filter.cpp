#include "wire/filter.h"

#include "wire/data_packet.h"

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

}  // namespace limb_ring::capture
