#include "judge/node_observer.h"

#include <utility>

#include "wire/data_packet.h"

namespace limb_ring::promises {

using Kind = Observation::Kind;
using std::chrono::nanoseconds;

NodeObserver::NodeObserver(const core::Settings& settings, nanoseconds zero, std::function<std::size_t()> waiting,
                           ObservationSink& sink, core::Duration goes_on)
    : settings_(settings),
      zero_(zero),
      waiting_(std::move(waiting)),
      sink_(sink),
      goes_on_(goes_on),
      cut_through_([this](const capture::PacketView& packet) {
        if (packet.whole()) came(packet.bytes, came_at_);
      }) {}

Observation NodeObserver::at(Kind kind, core::Time now) const {
  Observation seen;
  seen.kind = kind;
  seen.at_ns = (zero_ + core::whole_nanoseconds(now.time_since_epoch())).count();
  return seen;
}

// ---- in -------------------------------------------------------------------------------------

void NodeObserver::goes_in(const core::Input& input, core::Time now) {
  if (now == core::kNever) return;  // the two calls that are not told the time say nothing here
  if (now >= next_) say_it_goes_on(now);
  // Nearly always it is a packet that passes, so that is asked first: what passes must cost nothing.
  if (const auto* call = std::get_if<core::input::Receive>(&input)) return see(*call, now);
  std::visit([&](const auto& call) { see(call, now); }, input);
}

void NodeObserver::say_it_goes_on(core::Time now) {
  next_ = now + goes_on_;
  Observation seen = at(Kind::goes_on, now);
  seen.detail = waiting_() == 0 ? 1 : 0;
  sink_.put(seen);
}

// Packets on the second line are only passed back on it, so it is not observed. At a fold node that is not so: what it
// receives there is not reported.
void NodeObserver::see(const core::input::Receive& call, core::Time now) {
  if (call.line != core::Line::first) return;
  if (call.slice.kind == wire::SliceKind::whole || call.slice.kind == wire::SliceKind::interrupt)
    return came(call.slice.bytes, now);
  came_at_ = now;
  cut_through_.put(call.slice, nanoseconds(0));
}

void NodeObserver::see(const core::input::InputGap&, core::Time) { cut_through_.gap(nanoseconds(0)); }

void NodeObserver::see(const core::input::InputLost&, core::Time) { cut_through_.gap(nanoseconds(0)); }

void NodeObserver::came(wire::ByteView bytes, core::Time now) {
  const wire::PacketFields packet{bytes};
  const bool round = packet.hop() >= settings_.order.size();
  const bool broadcast =
      packet.destination() == wire::kBroadcast && packet.source() != settings_.id && packet.code().attempt == 0;
  if ((!round && !broadcast) || !packet.crc_good()) return;
  const bool interrupt = packet.code().interrupt;
  Observation seen = at(round ? Kind::circles : Kind::passed, now);
  seen.source = packet.source();
  seen.destination = packet.destination();
  seen.queue = interrupt ? Observation::kInterrupt : std::uint8_t{wire::priority_of(packet.last())};
  seen.channel =
      interrupt ? std::uint8_t{wire::factor_of(packet.last())} : std::uint8_t{wire::channel_of(packet.last())};
  seen.size = round ? packet.hop() : static_cast<std::uint16_t>(packet.data().size);
  if (!interrupt) seen.checksum = wire::crc32(packet.data());
  if (round || interrupt || !wire::is_control(packet)) sink_.put(seen);
}

void NodeObserver::see(const core::input::Send& call, core::Time now) {
  Observation seen = at(Kind::asked, now);
  seen.owner = call.request.owner;
  seen.token = call.request.token;
  seen.destination = call.request.destination;
  seen.queue = call.request.priority & 3;
  seen.channel = call.request.channel;
  seen.size = static_cast<std::uint16_t>(call.request.data.size);
  seen.checksum = wire::crc32(call.request.data);
  sink_.put(seen);
}

void NodeObserver::see(const core::input::Interrupt& call, core::Time now) { asks_for_interrupt(call.request, now); }

void NodeObserver::see(const core::input::Pull& call, core::Time now) {
  core::InterruptRequest request;
  request.owner = call.owner;
  request.token = call.token;
  if (call.input < settings_.inputs.size() && settings_.inputs[call.input]) {
    request.destination = settings_.inputs[call.input]->destination;
    request.factor = settings_.inputs[call.input]->factor;
  }
  asks_for_interrupt(request, now);
}

void NodeObserver::asks_for_interrupt(const core::InterruptRequest& request, core::Time now) {
  Observation seen = at(Kind::asked, now);
  seen.owner = request.owner;
  seen.token = request.token;
  seen.destination = request.destination;
  seen.queue = Observation::kInterrupt;
  seen.channel = request.factor;
  sink_.put(seen);
}

void NodeObserver::see(const core::input::CpuReset&, core::Time now) { sink_.put(at(Kind::flushed, now)); }

// ---- out ------------------------------------------------------------------------------------

void NodeObserver::taken(const core::Event& event, core::Time now) {
  if (const auto* end = std::get_if<core::SendEnded>(&event.what)) {
    if (end->owner == core::kController) return;
    Observation seen = at(Kind::ended, now);
    seen.owner = end->owner;
    seen.token = end->token;
    seen.destination = end->destination;
    seen.queue = end->interrupt ? Observation::kInterrupt : std::uint8_t{0};
    seen.detail = static_cast<std::uint8_t>(end->outcome);
    seen.tries = static_cast<std::uint8_t>(end->tries);
    sink_.put(seen);
  } else if (const auto* pin = std::get_if<core::PinPulled>(&event.what)) {
    Observation seen = at(Kind::pin, now);
    seen.source = pin->source;
    seen.destination = settings_.id;
    seen.queue = Observation::kInterrupt;
    seen.channel = pin->factor;
    sink_.put(seen);
  } else if (const auto* state = std::get_if<core::StateChanged>(&event.what)) {
    Observation seen = at(Kind::state, now);
    seen.detail = static_cast<std::uint8_t>(state->after);
    sink_.put(seen);
  }
}

void NodeObserver::taken(const core::ReceivedPacket& packet, core::Time now) {
  Observation seen = at(Kind::taken, now);
  seen.source = packet.source;
  seen.destination = packet.destination;
  seen.queue = packet.priority;
  seen.channel = packet.channel;
  seen.size = packet.size;
  seen.checksum = wire::crc32(packet.bytes());
  sink_.put(seen);
}

// Four tries, each of which may wait for the line, after four tries of the previous send.
nanoseconds longest_send(const core::Settings& settings) {
  const core::Duration tries = wire::kTries * (settings.send_timeout() + settings.queue_timeout);
  return core::whole_nanoseconds(settings.queue_timeout + 2 * tries);
}

}  // namespace limb_ring::promises
