#include "sim/soak_stage.h"

#include <algorithm>

#include "config/core_settings.h"
#include "sim/virtual_line_faults.h"

namespace limb_ring::scenario {

using core::Line;
using fault::ToCpu;
using namespace std::chrono_literals;

namespace {

std::unique_ptr<sim::VirtualRing> soak_ring(const Scenario& scenario) {
  const config::LinkConfig& link = scenario.ring.nodes.front().link;
  const bool fold_back = scenario.ring.folds_back();
  sim::VirtualRingOptions options;
  options.nodes = static_cast<unsigned>(scenario.ring.nodes.size());
  options.byte_time = setup::byte_time(link);
  options.relay_delay = link.whole_delay();
  options.keep_logs = false;
  options.adjust = [paced = link.rate != 0, fold_back](core::Settings& settings) {
    sim::set_short_times(settings, paced, fold_back);
  };
  if (!scenario.clocks.empty()) options.drift = [&scenario](NodeId place) { return scenario.clocks[place]; };
  return std::make_unique<sim::VirtualRing>(options);
}

}  // namespace

SoakStage::SoakStage(const Scenario& scenario, std::uint64_t seed) : SoakStage(scenario, seed, soak_ring(scenario)) {}

SoakStage::SoakStage(const Scenario& scenario, std::uint64_t seed, std::unique_ptr<sim::VirtualRing> ring)
    : ModelStage(scenario, *ring, seed), ring_(std::move(ring)), invariants_(*ring_) {
  ring_->on_event = [this](NodeId at, const core::Event& event) { senders().came(event, at); };
  ring_->on_packet = [this](NodeId, const core::ReceivedPacket& packet) {
    if (const auto send = senders().send_of(packet)) senders().taken(*send);
  };
  for (const NodeId id : ring_->order())
    for (const Line line : ring_->lines()) tap(id, line);
  for (const NodeId id : scenario.absent) ring_->kill(id);
}

// ---- time -----------------------------------------------------------------------------------

bool SoakStage::run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) {
  if (until.count() == 0) return done();  // steps at 0s come before the nodes start
  return ModelStage::run_until(done, until, what);
}

std::optional<Stage::Failure> SoakStage::end() {
  if (!scenario().ends_mended) return std::nullopt;
  quiet_ = true;
  mend_all();
  sim::run_until_calm(*ring_, invariants_, slices_when_quiet_);
  invariants_.finish();
  if (broken()) return broken();
  if (const auto violation = sim::not_whole(*ring_)) return failure_of(violation);
  slices_when_quiet_ = 0;
  ring_->run_for(20ms);
  if (broken()) return broken();
  return failure_of(sim::not_silent(*ring_, slices_when_quiet_));
}

void SoakStage::mend_all() {
  strikes_.clear();
  lines().mend_all();
  for (const NodeId id : ring_->order()) {
    ring_->set_cpu_reads(id, true);
    scenario().ring.folds_back() ? ring_->heal_cable(id) : ring_->heal(id);
    if (!ring_->alive(id)) bring_back(id);
  }
}

// ---- lines ----------------------------------------------------------------------------------

void SoakStage::tap(NodeId id, Line line) {
  const auto tap = [this, id, line](const wire::Slice& slice, core::Time, wire::SliceWriter& arriving) {
    pass(id, line, slice, arriving);
  };
  ring_->tap(id, tap, line);
}

void SoakStage::pass(NodeId id, Line line, const wire::Slice& slice, wire::SliceWriter& arriving) {
  if (quiet_ && sim::is_traffic(slice)) ++slices_when_quiet_;
  const auto strike = strike_at(id, line);
  if (!strike) return lines().pass(id, line, slice, arriving);
  if (strike->kind == SoakAction::Kind::lose_slice) return;
  if (slice.bytes.empty()) return lines().pass(id, line, slice, arriving);
  const std::size_t byte = std::min<std::size_t>(strike->byte, slice.bytes.size - 1);
  lines().pass_damaged(id, line, slice, byte, strike->bits, arriving);
}

std::optional<SoakAction> SoakStage::strike_at(NodeId id, Line line) {
  std::optional<SoakAction> hit;
  for (Strike& strike : strikes_)
    if (strike.what.node == id && strike.line == line && --strike.left == 0) hit = strike.what;
  if (hit) {
    const auto over = [](const Strike& strike) { return strike.left == 0; };
    strikes_.erase(std::remove_if(strikes_.begin(), strikes_.end(), over), strikes_.end());
  }
  return hit;
}

// ---- actions --------------------------------------------------------------------------------

void SoakStage::apply(const SoakAction& action) {
  using Kind = SoakAction::Kind;
  const Line line = action.second_line ? Line::second : Line::first;
  switch (action.kind) {
    case Kind::cut_wire:
      return ring_->cut(action.node, line);
    case Kind::mend_wire:
      return ring_->heal(action.node, line);
    case Kind::cut_cable:
      return ring_->cut_cable(action.node);
    case Kind::mend_cable:
      return ring_->heal_cable(action.node);
    case Kind::cancel:
      if (ring_->alive(action.node)) ring_->cancel(action.node);
      return;
    case Kind::lose_slice:
    case Kind::damage_slice:
      strikes_.push_back({action, line, action.nth});
  }
}

bool SoakStage::can(const Fault& fault) {
  const fault::Word& word = fault::word_of(fault.name);
  const bool reads_nothing = word.to_cpu == ToCpu::read_slowly && (word.keys & fault::kEvery) == 0;
  return word.of != fault::Of::cpu || reads_nothing || word.to_cpu == ToCpu::cure || word.to_cpu == ToCpu::restart;
}

// @pre can(fault)
void SoakStage::apply_to_cpu(const Fault& fault, NodeId id) {
  const ToCpu what = fault::word_of(fault.name).to_cpu;
  if (what != ToCpu::restart) return ring_->set_cpu_reads(id, what == ToCpu::cure);
  if (ring_->alive(id)) ring_->reset_cpu(id);
}

}  // namespace limb_ring::scenario
