#include "virtual_host/virtual_ring_host.h"

#include "setup/core_settings.h"

namespace limb_ring::virtual_host {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// So long the ring is simulated before clients get their turn.
constexpr milliseconds kTurn{2};
/// The clock is read once in so many instants.
constexpr unsigned kInstantsPerLook = 64;

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
      wake_(io, [] {}) {
  for (const wire::NodeId id : ring_.order())
    ring_.set_cpu_reads(id, false);  // they are given what waits for them by their nodes
  for (const config::NodeConfig& node : ring.nodes) add(node);
  ring_.on_event = [this](wire::NodeId id, const core::Event& event) { drivers_[id]->on_event(event); };
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
  base.log_prefix = node.name + ": ";
  nodes_.push_back(std::make_unique<runtime::Node>(io_, config_, node, base));
}

void VirtualRingHost::start() {
  for (const auto& node : nodes_) node->start();
}

void VirtualRingHost::stop(const std::function<void()>& done) {
  const auto left = std::make_shared<std::size_t>(nodes_.size());
  for (const auto& node : nodes_)
    node->stop([left, done] {
      if (--*left == 0) done();
    });
}

// ---- time -----------------------------------------------------------------------------------

void VirtualRingHost::run(Pace& pace) {
  while (!io_.stopped()) {
    io_.poll();
    advance(pace.allowed(steady_clock::now(), ring_.now()));
    if (io_.poll() != 0 || io_.stopped()) continue;
    const core::Time next = ring_.next_instant();
    if (next == core::kNever || pace.when(next) <= steady_clock::now()) continue;
    wake_.expires_at(pace.when(next));
    io_.run_one();
  }
}

void VirtualRingHost::advance(core::Time until) {
  const auto end = steady_clock::now() + kTurn;
  unsigned instants = 0;
  const auto over = [&] {
    if (lines_changed_) look_at_lines();
    return ++instants % kInstantsPerLook == 0 && steady_clock::now() >= end;
  };
  if (until < ring_.now()) return;
  if (!ring_.run_until(over, until - ring_.now())) ring_.run_until(until);
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
