#include "virtual_host/virtual_ring_host.h"

#include <algorithm>

#include "setup/core_settings.h"
#include "virtual_host/turnaround.h"

namespace limb_ring::virtual_host {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// So long the ring is simulated before clients get their turn.
constexpr milliseconds kTurn{2};
/// The clock is read once in so many instants.
constexpr unsigned kInstantsPerLook = 64;
/// So often those that are waited for are looked at, should nothing come.
constexpr milliseconds kTick{100};
/// Nobody waits for an instant: so far the ring goes on at once.
constexpr std::chrono::milliseconds kLongestStep{10};

/// The simulation has a controller for every number up to the largest id; those that are no node's are never alive.
core::Settings settings_of(const config::RingConfig& ring, const core::Settings& given) {
  const config::NodeConfig* node = ring.find(given.id);
  core::Settings settings = setup::core_settings(ring, node ? *node : ring.nodes.front(), given.boot);
  settings.id = given.id;
  return settings;
}

sim::VirtualRingOptions options_of(const config::RingConfig& ring) {
  sim::VirtualRingOptions options;
  options.order = setup::order_of(ring);
  options.keep_logs = false;
  options.adjust = [&ring](core::Settings& settings) { settings = settings_of(ring, settings); };
  return options;
}

}  // namespace

VirtualRingHost::VirtualRingHost(boost::asio::io_context& io, const config::RingConfig& ring)
    : io_(io),
      config_(ring),
      ring_(options_of(ring)),
      clock_(ring_),
      faults_(ring_, 0),  // every fault whose damage is random comes with a seed of its own
      drivers_(ring_.size(), nullptr),
      lockstep_(ring_, ring),
      trace_(ring_),
      wake_(io, [] {}) {
  clock_.on_expired = [this] { lockstep_.has_news(); };
  for (const wire::NodeId id : ring_.order())
    ring_.set_cpu_reads(id, false);  // they are given what waits for them by their nodes
  for (const config::NodeConfig& node : ring.nodes) add(node);
  ring_.on_event = [this](wire::NodeId id, const core::Event& event) {
    if (std::holds_alternative<core::PinPulled>(event.what)) lockstep_.has_news();
    drivers_[id]->on_event(event);
  };
  ring_.on_given_out = [this](wire::NodeId id) { drivers_[id]->on_given_out(); };
  ring_.add_observer(*this);
}

VirtualRingHost::~VirtualRingHost() = default;

void VirtualRingHost::add(const config::NodeConfig& node) {
  runtime::NodeBase base;
  base.make_driver = [this, &node](const runtime::NodeFolder&, runtime::EngineListener& listener) {
    auto driver = std::make_unique<VirtualNode>(VirtualWorld{ring_, clock_, faults_}, wire::NodeId{node.id}, listener);
    drivers_[node.id] = driver.get();
    return driver;
  };
  base.turns = &lockstep_;
  if (node.cpu.turnaround.count() + node.cpu.jitter.count() != 0)
    base.make_filter = [this, &node](host::HostHandler& calls) {
      const std::uint64_t seed = std::uint64_t{config_.virtual_clock.seed} << 8 | node.id;
      return std::make_unique<Turnaround>(calls, ring_, node.cpu, seed);
    };
  base.on_cpu_changed = [this, id = node.id](const runtime::CpuStatus& cpu) { lockstep_.cpu_changed(id, cpu); };
  base.log_prefix = node.name + ": ";
  nodes_.push_back(std::make_unique<runtime::Node>(io_, config_, node, base));
}

void VirtualRingHost::start() {
  for (const auto& node : nodes_) node->start();
}

void VirtualRingHost::stop(const std::function<void()>& done) {
  if (std::exchange(stopping_, true)) return;
  const auto left = std::make_shared<std::size_t>(nodes_.size());
  for (const auto& node : nodes_)
    node->stop([left, done] {
      if (--*left == 0) done();
    });
}

// ---- time -----------------------------------------------------------------------------------

void VirtualRingHost::run(Pace& pace, core::Time end) {
  while (!io_.stopped()) {
    io_.poll();
    if (stopping_) {  // time stands
      io_.run_one();
      continue;
    }
    if (io_.stopped() || !all_wait()) continue;
    if (ring_.now() >= end) {
      stop([this] { io_.stop(); });
      continue;
    }
    const core::Time most = std::min({end, lockstep_.next_wake(), lockstep_.held_at()});
    advance(std::min(most, pace.allowed(steady_clock::now(), ring_.now())));
    if (!lockstep_.has_news_now()) sleep_until(pace.when(std::min(most, ring_.next_instant())));
  }
}

bool VirtualRingHost::all_wait() {
  if (lockstep_.somebody_acts()) {
    lockstep_.listen();
    return false;
  }
  lockstep_.take_news();
  ring_.run_until(ring_.now());  // what was asked for in this instant
  if (lockstep_.take_news()) return false;
  if (lockstep_.give_turns()) {
    lockstep_.listen();
    return false;
  }
  if (lockstep_.held_at() > ring_.now()) return true;
  if (!lockstep_.attach_those_due()) sleep_until(steady_clock::now() + kTick);
  return false;
}

// What is posted to the event loop, or is for a program, comes before the next instant.
void VirtualRingHost::advance(core::Time until) {
  const auto end = steady_clock::now() + kTurn;
  unsigned instants = 0;
  const auto over = [&] {
    if (lines_changed_) look_at_lines();
    return lockstep_.has_news_now() || (++instants % kInstantsPerLook == 0 && steady_clock::now() >= end);
  };
  if (until <= ring_.now()) return;
  if (until == core::kNever) until = ring_.now() + kLongestStep;
  if (!ring_.run_until(over, until - ring_.now())) ring_.run_until(until);
}

void VirtualRingHost::sleep_until(Pace::Real when) {
  if (when <= steady_clock::now() || io_.poll() != 0) return;
  wake_.expires_at(when);
  io_.run_one();
}

// ---- from the ring --------------------------------------------------------------------------

void VirtualRingHost::arrives(wire::NodeId node, const wire::Slice& slice, core::Time now) {
  drivers_[node]->on_arrival(slice, now);
}

void VirtualRingHost::leaves(wire::NodeId node, const wire::Slice& slice, core::Time now) {
  drivers_[node]->on_departure(slice, now);
}

void VirtualRingHost::input_changes(wire::NodeId, core::Line, core::Time) { lines_changed_ = true; }

void VirtualRingHost::incident(wire::NodeId, sim::Incident, core::Time, core::Line) { lines_changed_ = true; }

void VirtualRingHost::look_at_lines() {
  lines_changed_ = false;
  for (VirtualNode* driver : drivers_)
    if (driver != nullptr) driver->look_at_lines();
}

}  // namespace limb_ring::virtual_host
