#include "sim/virtual_stage.h"

#include "sim/planned_ring.h"

namespace limb_ring::scenario {

using config::PinConfig;
using fault::Name;

VirtualStage::VirtualStage(const Scenario& scenario, std::uint64_t seed)
    : VirtualStage(scenario, seed, sim::planned_ring(scenario.ring)) {}

VirtualStage::VirtualStage(const Scenario& scenario, std::uint64_t seed, std::unique_ptr<sim::WatchedRing> ring)
    : ModelStage(scenario, *ring, seed),
      ring_(std::move(ring)),
      cpus_(*ring_, scenario.boot_time),
      supervisor_(scenario.ring, *ring_, cpus_) {
  ring_->on_event = [this](NodeId at, const core::Event& event) { came(event, at); };
  ring_->on_packet = [this](NodeId at, const core::ReceivedPacket& packet) {
    if (const auto send = senders().send_of(packet)) senders().taken(*send);
    cpus_.took_packet(at);
  };
  lines().tap_all();
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

// ---- actions --------------------------------------------------------------------------------

void VirtualStage::came(const core::Event& event, NodeId at) {
  senders().came(event, at);
  supervisor_.came(event, at);
  const auto* pin = std::get_if<core::PinPulled>(&event.what);
  if (!pin || scenario().ring.nodes[at].pins[pin->factor].action != PinConfig::Action::reset) return;
  ring_->at(ring_->now(), [this, at] { cpus_.reset(at); });
}

void VirtualStage::apply_to_cpu(const Fault& fault, NodeId id) {
  switch (fault.name) {
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
      return;  // of a line or a node
  }
}

void VirtualStage::started(NodeId id) {
  cpus_.started(id);
  supervisor_.started(id);
}

}  // namespace limb_ring::scenario
