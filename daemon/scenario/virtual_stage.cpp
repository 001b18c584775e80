#include "scenario/virtual_stage.h"

#include "sim_tools/planned_ring.h"

namespace limb_ring::scenario {

using config::PinConfig;
using fault::Name;

VirtualStage::VirtualStage(const Scenario& scenario, std::uint64_t seed)
    : VirtualStage(scenario, seed, sim::planned_ring(scenario.ring)) {}

VirtualStage::VirtualStage(const Scenario& scenario, std::uint64_t seed, std::unique_ptr<sim::WatchedRing> ring)
    : RingStage(scenario, *ring, seed),
      ring_(std::move(ring)),
      frozen_(ring_->size(), false),
      cpus_(*ring_, scenario.boot_time),
      supervisor_(scenario.ring, *ring_, cpus_),
      lines_(*ring_, seed) {
  ring_->on_event = [this](NodeId at, const core::Event& event) { came(event, at); };
  ring_->on_packet = [this](NodeId at, const core::ReceivedPacket& packet) {
    if (const auto send = senders().send_of(packet)) senders().taken(*send);
    cpus_.took_packet(at);
  };
  lines_.tap_all();
  supervisor_.start();
  for (const NodeId id : scenario.absent) ring_->kill(id);
}

// ---- time ----------------------------------------------------------------------------------

std::optional<Stage::Failure> VirtualStage::begin() {
  const bool joined = ring_->join();
  start_counting();
  if (joined) return std::nullopt;
  return Failure{"every node joins", "not within 10 s"};
}

bool VirtualStage::run_until(const std::function<bool()>& done, core::Duration until, const std::string&) {
  const core::Time end = at(until);
  if (ring_->run_until(done, end - ring_->now())) return true;
  ring_->run_until(end);
  return done();
}

// ---- actions --------------------------------------------------------------------------------

void VirtualStage::came(const core::Event& event, NodeId at) {
  senders().came(event, at);
  supervisor_.came(event, at);
  const auto* pin = std::get_if<core::PinPulled>(&event.what);
  if (!pin || scenario().ring.nodes[at].pins[pin->factor].action != PinConfig::Action::reset) return;
  ring_->at(ring_->now(), [this, at] { cpus_.reset(at); });
}

std::optional<Stage::Failure> VirtualStage::apply(const Fault& fault) {
  do_it(fault);
  return std::nullopt;
}

void VirtualStage::do_it(const Fault& fault) {
  if (fault::word_of(fault.name).of == fault::Of::line) return lines_.begin(fault);
  // All are off before the first is on again.
  if (fault.name == Name::power_cycle)
    for (const NodeId id : fault.nodes) ring_->kill(id);
  for (const NodeId id : fault.nodes) apply(fault, id);
  if (fault.lasts.count() != 0) end_later(fault);
}

void VirtualStage::end_later(const Fault& fault) {
  Fault end;
  end.name = fault.name == Name::freeze ? Name::thaw : Name::resume;
  end.nodes = fault.nodes;
  ring_->at(ring_->now() + core::Duration(fault.lasts), [this, end] { do_it(end); });
}

void VirtualStage::apply(const Fault& fault, NodeId id) {
  switch (fault.name) {
    case Name::kill:
      return ring_->kill(id);
    case Name::start:
    case Name::power_cycle:
      return start(id);
    case Name::freeze:
      frozen_[id] = ring_->alive(id);
      return ring_->freeze(id);
    case Name::thaw:
      if (frozen_[id]) ring_->thaw(id);
      frozen_[id] = false;
      return;
    case Name::hang:
      return cpus_.hang(id);
    case Name::resume:
      return cpus_.resume(id);
    case Name::reset:
      return cpus_.reset(id);
    case Name::crash:
      return cpus_.crash(id);
    case Name::slow:
      return cpus_.slow_down(id, fault.every);
    case Name::not_reading:
      return cpus_.stop_reading(id);
    case Name::babble:
      return senders().babble(id, fault.every, [this, id, generation = cpus_.generation(id)] {
        return cpus_.generation(id) != generation;
      });
    default:
      return;  // of a line: never of a node
  }
}

void VirtualStage::start(NodeId id) {
  if (ring_->alive(id)) return;
  frozen_[id] = false;
  ring_->start(id);
  cpus_.started(id);
  supervisor_.started(id);
}

}  // namespace limb_ring::scenario
