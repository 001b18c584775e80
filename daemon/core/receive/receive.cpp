#include "core/receive/receive.h"

#include <algorithm>
#include <cstring>

namespace limb_ring::core {

using wire::PacketFields;

std::size_t Receive::free_buffers(const PacketFields& packet) const {
  if (wire::is_control(packet)) return wire::kFbcMax;
  if (!cpu_present_) return 0;
  const std::size_t used = buffers_[wire::priority_of(packet.last())].size();
  return settings_.receive_buffers > used ? settings_.receive_buffers - used : 0;
}

bool Receive::accepts(const PacketFields& packet) {
  if (!membership_.joined()) return counted(counters_.refused_joining, false);
  if (!cpu_present_) return counted(counters_.refused_cpu_absent, false);
  if (free_buffers(packet) == 0) return counted(counters_.refused_no_buffer, false);
  return true;
}

std::uint8_t Receive::take_in(const PacketFields& packet, Time at) {
  if (wire::is_control(packet) && !membership_.heard(packet, at)) return 0;
  if (membership_.is_unheard_nodes_retry(packet)) return packet.fbc();
  return offer(packet, at);
}

std::uint8_t Receive::offer(const PacketFields& packet, Time at) {
  if (!addressed(packet)) return packet.fbc();
  if (!memory_.meet(packet.source(), packet.code().incarnation))
    return counted(counters_.earlier_incarnation, std::uint8_t{0});
  const bool broadcast = packet.destination() == wire::kBroadcast;
  const std::size_t free = std::min<std::size_t>(free_buffers(packet), wire::kFbcMax);
  const auto least = [&](std::size_t value) {
    return static_cast<std::uint8_t>(std::min<std::size_t>(packet.fbc(), value));
  };
  // Taking a hello or beacon twice does no harm; but a verdict on an older packet with its number must not keep it
  // out.
  if (wire::is_control(packet)) {
    memory_.remember(packet.source(), packet.code(), broadcast, Verdict::taken, at);
    ++counters_.received_control;
    return least(free);
  }
  switch (memory_.verdict(packet.source(), packet.code(), broadcast, at)) {
    case Verdict::taken:
      return counted(counters_.duplicates, least(std::max<std::size_t>(1, free)));
    case Verdict::refused:
      return counted(counters_.duplicates, std::uint8_t{0});
    case Verdict::doubtful:
      return counted(counters_.doubtful_retries, packet.fbc());
    case Verdict::none:
      break;
  }
  if (membership_.is_unaware_nodes_retry(packet, at)) return packet.fbc();
  const bool taken = accepts(packet);
  memory_.remember(packet.source(), packet.code(), broadcast, taken ? Verdict::taken : Verdict::refused, at);
  if (!taken) return 0;
  store(packet, at);
  return least(free);
}

void Receive::store(const PacketFields& packet, Time at) {
  ++counters_.received_data;
  ReceivedPacket& slot = buffers_[wire::priority_of(packet.last())].push();
  ++waiting_;
  slot.at = at;
  slot.source = packet.source();
  slot.destination = packet.destination();
  slot.priority = wire::priority_of(packet.last());
  slot.channel = wire::channel_of(packet.last());
  slot.size = static_cast<std::uint16_t>(packet.data().size);
  std::memcpy(slot.data.data(), packet.data().data, slot.size);
}

bool Receive::take_due(Time now, ReceivedPacket& out) {
  for (auto& buffer : buffers_) {
    if (buffer.empty() || buffer.front().at > now) continue;
    out = buffer.front();
    buffer.pop();
    --waiting_;
    return true;
  }
  return false;
}

Time Receive::earliest() const {
  Time next = kNever;
  for (const auto& buffer : buffers_)
    if (!buffer.empty()) next = std::min(next, buffer.front().at);
  return next;
}

void Receive::flush() {
  counters_.flushed_on_reset += waiting_;
  for (auto& buffer : buffers_) buffer.clear();
  waiting_ = 0;
}

bool Pins::addressed(const wire::PacketFields& packet) const {
  if (packet.destination() == wire::kBroadcast) return packet.source() != settings_.id;
  return packet.destination() == settings_.id;
}

std::uint8_t Pins::offer(const wire::PacketFields& packet, Time at) {
  if (!addressed(packet)) return packet.fbc();
  if (!memory_.meet(packet.source(), packet.code().incarnation))
    return counted(counters_.earlier_incarnation, std::uint8_t{0});
  const bool broadcast = packet.destination() == wire::kBroadcast;
  Verdict verdict = memory_.verdict(packet.source(), packet.code(), broadcast, at);
  if (verdict == Verdict::doubtful) return counted(counters_.doubtful_retries, packet.fbc());
  if (verdict == Verdict::none) {
    if (membership_.is_unaware_nodes_retry(packet, at)) return packet.fbc();
    verdict = pull(packet, at) ? Verdict::taken : Verdict::refused;
    memory_.remember(packet.source(), packet.code(), broadcast, verdict, at);
  } else {
    ++counters_.duplicates;
  }
  return std::min<std::uint8_t>(packet.fbc(), verdict == Verdict::taken ? 1 : 0);
}

bool Pins::pull(const wire::PacketFields& packet, Time at) {
  const wire::Factor factor = wire::factor_of(packet.last());
  if (!settings_.wired[factor]) return counted(counters_.refused_unwired, false);
  ++counters_.pins_pulled;
  events_.put(at, PinPulled{factor, packet.source()});
  return true;
}

}  // namespace limb_ring::core
