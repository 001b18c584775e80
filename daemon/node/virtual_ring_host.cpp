#include "node/virtual_ring_host.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>

#include "config/core_settings.h"
#include "limb_ring/ring_directory.h"
#include "node/fault_requests.h"
#include "node/requests.h"
#include "node/steering.h"

namespace limb_ring::virtual_host {

using nlohmann::json;
using runtime::RequestError;

namespace {

constexpr const char* kWhoseThisIs = "this is the host port of the whole ring, not of a node";

}  // namespace

RingPort::RingPort(boost::asio::io_context& io, host::HostOptions options, fault::RingNodes nodes,
                   RingRequests requests)
    : nodes_(std::move(nodes)),
      requests_(std::move(requests)),
      host_(io, options, *this),
      watch_(io, {ring_directory(options.ring), [this] { return host_.is_in_place(); },
                  [this, ring = options.ring] {
                    make_ring_directory(ring);
                    host_.listen_again();
                  },
                  [] {}}) {
  watch_.start();
}

void RingPort::close() {
  watch_.stop();
  host_.close();
}

std::optional<std::string> RingPort::on_attach(const host::ClientInfo& client) {
  if (client.role == Role::cpu) return std::string(kWhoseThisIs) + ": it has no CPU";
  return std::nullopt;
}

// ---- what only a node does ------------------------------------------------------------------

void RingPort::reject(host::ClientId client, std::uint32_t token) {
  Result result;
  result.token = token;
  result.outcome = Outcome::rejected;
  result.why = Reason::not_in_ring;
  result.reason = kWhoseThisIs;
  host_.result(client, result);
}

void RingPort::on_send(host::ClientId client, const client::SendRequest& request) { reject(client, request.token); }

void RingPort::on_interrupt(host::ClientId client, const client::InterruptRequest& request) {
  reject(client, request.token);
}

void RingPort::on_pull(host::ClientId client, const client::PullRequest& request) { reject(client, request.token); }

void RingPort::on_observe(host::ClientId client, const client::ObserveRequest&) {
  host_.observed(client, runtime::text_of({{"error", std::string(kWhoseThisIs) + ": it sees no packets"}}));
}

// ---- requests -------------------------------------------------------------------------------

void RingPort::on_request(host::ClientId client, const client::JsonRequest& request) {
  const auto answer = [this, client, token = request.token](const json& reply) {
    host_.reply(client, token, runtime::text_of(reply));
  };
  try {
    const json what = runtime::object_in(std::string(request.json), runtime::kRequestRule);
    const runtime::RequestKind* kind = runtime::find_request_kind(what);
    if (kind != nullptr) runtime::require_known_members(what, *kind);
    if (kind != nullptr && kind->name == "fault") return begin_fault(what, answer);
    if (kind != nullptr && kind->name == "clock") return answer(state());
    if (kind == nullptr || !runtime::answer_clock_request(&requests_.clock, *kind, what, answer))
      throw RequestError(std::string(kWhoseThisIs) + ": there are allow, clock, fault, pace, pause, run, step");
  } catch (const std::exception& error) {
    answer({{"error", error.what()}});
  }
}

json RingPort::state() const {
  json state = json::object();
  runtime::add_state(requests_.clock, state);
  return state;
}

void RingPort::begin_fault(const json& request, const std::function<void(const json&)>& answer) {
  if (!request.contains("fault") || !request["fault"].is_string())
    throw RequestError("fault is missing: a text as 'ringctl fault' takes it, 'kill knee'");
  const fault::Fault fault = fault::from_words(request["fault"].get<std::string>(), nodes_);
  if (fault::word_of(fault.name).of != fault::Of::node)
    throw RequestError(std::string(fault::word_of(fault.name).word) +
                       ": a fault of a line or CPU is begun at the node where it is");
  const std::string words = fault::to_words(fault, nodes_);
  requests_.fault(fault, [answer, words](const std::string& problem) {
    answer(problem.empty() ? json{{"fault", words}} : json{{"error", problem}});
  });
}

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// How long, in real time, the ring is simulated before the event loop has its turn.
constexpr milliseconds kTurn{2};
/// The real clock is read once in this many instants, since reading it costs time.
constexpr unsigned kInstantsPerLook = 64;
/// How often we look at those that are waited for, if no event comes.
constexpr milliseconds kTick{100};
/// How far the ring goes on in one step if no program waits for an instant.
constexpr std::chrono::milliseconds kLongestStep{10};

/// The simulation has a controller for every number up to the largest id; those without a node are never alive.
core::Settings settings_of(const config::RingConfig& ring, const core::Settings& given) {
  const config::NodeConfig* node = ring.find(given.id);
  core::Settings settings = setup::core_settings(ring, node ? *node : ring.nodes.front(), given.boot);
  settings.id = given.id;
  return settings;
}

/// The ring's own host port: its id is that of all nodes (kBroadcast).
host::HostOptions port_options(const config::RingConfig& ring, const std::string& folder) {
  return {folder, ring.ring, wire::kBroadcast, "", ring.limits.clients};
}

sim::VirtualRingOptions options_of(const config::RingConfig& ring) {
  sim::VirtualRingOptions options;
  options.order = setup::order_of(ring);
  options.keep_logs = false;
  options.adjust = [&ring](core::Settings& settings) { settings = settings_of(ring, settings); };
  return options;
}

}  // namespace

VirtualRingHost::VirtualRingHost(boost::asio::io_context& io, const config::RingConfig& ring,
                                 const VirtualRingHostOptions& options)
    : io_(io),
      config_(ring),
      options_(options),
      ring_(options_of(ring)),
      faults_(ring_, options.line_fault_seed),
      drivers_(ring_.size(), nullptr),
      lockstep_(ring_, ring),
      steering_(ring_),
      trace_(ring_),
      wake_(io, [] {}) {
  for (const wire::NodeId id : ring_.order())
    ring_.set_cpu_reads(id, false);  // they are given what waits for them by their nodes
  for (const config::NodeConfig& node : ring.nodes) {
    if (options_.libraries && !node.library.empty()) {
      libraries_[node.id] = std::make_unique<LibraryNode>(ring_, ring, node);
      continue;
    }
    folders_[node.id] = std::make_shared<runtime::NodeFolder>(ring, node);
    add(node);
  }
  // All nodes are held by now: nobody else's files are in these places.
  const fault::RingNodes names = fault::nodes_by_id(ring);
  NodePower& power = *this;
  node_faults_.emplace(ring_, power, names, folders_.begin()->second->path());
  port_.emplace(io, port_options(ring, folders_.begin()->second->path()), names,
                RingRequests{[this](const fault::Fault& fault, auto done) { begin_at_nodes(fault, std::move(done)); },
                             steering_});
  if (nodes_.empty()) throw std::runtime_error("all its nodes are foreign; a virtual ring has one of ours at least");
  ring_.on_event = [this](wire::NodeId id, const core::Event& event) {
    if (std::holds_alternative<core::PinPulled>(event.what)) lockstep_.has_news();
    drivers_[id]->on_event(event);
  };
  ring_.on_given_out = [this](wire::NodeId id) { drivers_[id]->on_given_out(); };
  ring_.add_observer(*this);
}

VirtualRingHost::~VirtualRingHost() = default;

void VirtualRingHost::add(const config::NodeConfig& node) {
  nodes_[node.id] = std::make_unique<runtime::Node>(io_, config_, node, base_of(node));
}

runtime::NodeBase VirtualRingHost::base_of(const config::NodeConfig& node) {
  runtime::NodeBase base;
  base.folder = folders_.at(node.id);
  base.start_anew = [this, &node] {
    fault::Fault fault;
    fault.name = fault::Name::power_cycle;
    fault.nodes = {wire::NodeId{node.id}};
    begin_at_nodes(fault, [](const std::string& problem) {
      if (!problem.empty()) spdlog::error("power_cycle: {}", problem);
    });
  };
  base.make_driver = [this, &node](const runtime::NodeFolder&, runtime::DriverListener& listener) {
    const VirtualWorld world{ring_, faults_, [this] { lockstep_.has_news(); }};
    auto driver = std::make_unique<VirtualNode>(world, wire::NodeId{node.id}, listener);
    drivers_[node.id] = driver.get();
    return driver;
  };
  base.turns = &lockstep_;
  base.clock = &steering_;
  if (node.cpu.turnaround.count() + node.cpu.jitter.count() != 0)
    base.make_filter = [this, &node](host::HostHandler& calls) {
      const std::uint64_t seed = std::uint64_t{config_.virtual_clock.seed} << 8 | node.id;
      return std::make_unique<Turnaround>(calls, ring_, drivers_[node.id]->clock(), node.cpu, seed);
    };
  base.on_cpu_changed = [this, id = node.id](const runtime::CpuStatus& cpu) {
    lockstep_.cpu_changed(id, cpu);
    on_cpu_changed(id, cpu);
  };
  base.on_cpu_signal = [this, id = node.id](int number) { lockstep_.cpu_signalled(id, number); };
  base.cpu_boots_for = config_.virtual_clock.boot_time;
  base.cpu_output = options_.cpu_output;
  base.log_prefix = node.name + ": ";
  return base;
}

void VirtualRingHost::capture(std::ostream& out) { capture_.emplace(ring_, out, sim::names_of(config_)); }

void VirtualRingHost::start() {
  for (const auto& [id, library] : libraries_) library->switch_on();
  for (const auto& [id, node] : nodes_) node->start();
}

void VirtualRingHost::stop(const std::function<void()>& done) {
  if (std::exchange(stopping_, true)) return;
  port_->close();
  if (nodes_.empty()) return boost::asio::post(io_, done);  // all are dead
  const auto left = std::make_shared<std::size_t>(nodes_.size());
  for (const auto& [id, node] : nodes_)
    node->stop([left, done] {
      if (--*left == 0) done();
    });
}

// ---- faults of whole nodes ------------------------------------------------------------------

void VirtualRingHost::begin_at_nodes(const fault::Fault& fault, std::function<void(const std::string&)> done) {
  lockstep_.disturbed();
  lockstep_.has_news();
  ring_.at(ring_.now(), [this, fault, done = std::move(done)] { done(node_faults_->begin(fault)); });
}

// What follows from it comes before time goes on.
void VirtualRingHost::at(core::Time when, std::function<void()> action) {
  ring_.at(when, [this, action = std::move(action)] {
    action();
    lockstep_.has_news();
  });
}

void VirtualRingHost::begin(const fault::Fault& fault, const std::function<void(const std::string&)>& done) {
  if (fault::word_of(fault.name).of == fault::Of::node) return done(node_faults_->begin(fault));
  for (const wire::NodeId id : fault.nodes) {
    fault::Fault one = fault;
    one.nodes = {id};
    const auto node = nodes_.find(id);
    if (library(id) != nullptr) {
      done("node " + config_.find(id)->name + " is foreign: only its own code knows its CPU and its line");
      continue;
    }
    if (node == nodes_.end() || node_faults_->is_frozen(id)) {
      done("node " + config_.find(id)->name + (node == nodes_.end() ? " is dead" : " is frozen"));
      continue;
    }
    node->second->faults().begin(one, [done](runtime::Faults::Id, const std::string& problem) { done(problem); });
  }
}

LibraryNode* VirtualRingHost::library(wire::NodeId id) {
  const auto found = libraries_.find(id);
  return found == libraries_.end() ? nullptr : found->second.get();
}

void VirtualRingHost::off(wire::NodeId id) {
  if (LibraryNode* foreign = library(id)) return foreign->switch_off();
  nodes_.at(id)->die();
  drivers_[id] = nullptr;
  nodes_.erase(id);
  ring_.kill(id);
  for (const core::Line line : ring_.lines()) faults_.clear(id, line);
  lockstep_.node_died(id);
  lockstep_.has_news();
}

std::string VirtualRingHost::on(wire::NodeId id) {
  LibraryNode* foreign = library(id);
  if (!foreign) ring_.start(id);
  try {
    if (foreign) return foreign->switch_on(), "";
    if (!folders_.at(id)->is_in_place()) folders_.at(id)->make_again();
    add(*config_.find(id));
  } catch (const std::exception& problem) {
    drivers_[id] = nullptr;
    ring_.kill(id);
    return problem.what();
  }
  nodes_.at(id)->start();
  lockstep_.node_started(id);
  lockstep_.has_news();
  return "";
}

void VirtualRingHost::freeze(wire::NodeId id, bool clock_stands) {
  if (LibraryNode* foreign = library(id)) return foreign->freeze();
  ring_.freeze(id, clock_stands);
  drivers_[id]->clock().freeze();
  nodes_.at(id)->freeze();
  lockstep_.node_frozen(id);
  lockstep_.has_news();
}

void VirtualRingHost::thaw(wire::NodeId id) {
  if (LibraryNode* foreign = library(id)) return foreign->thaw();
  ring_.thaw(id);
  lockstep_.node_thawed(id);
  lockstep_.has_news();
  nodes_.at(id)->thaw();
  drivers_[id]->clock().thaw();
}

std::string VirtualRingHost::not_repeatable() const {
  const std::string why = lockstep_.not_repeatable();
  if (steering_.left_behind().empty()) return why;
  return why + (why.empty() ? "" : ", and ") + "time went on without " + steering_.left_behind();
}

// ---- time -----------------------------------------------------------------------------------

void VirtualRingHost::run(Pace& pace, core::Time end) {
  steering_.use(pace);
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
    if (steering_.holds()) {
      sleep_until(steady_clock::now() + kTick);
      continue;
    }
    const core::Time most = std::min({end, lockstep_.next_wake(), lockstep_.held_at(), steering_.limit()});
    advance(std::min(most, pace.allowed(steady_clock::now(), ring_.now())), [] { return false; });
    if (!lockstep_.has_news_now()) sleep_until(pace.when(std::min(most, ring_.next_instant())));
  }
}

bool VirtualRingHost::run_until(const std::function<bool()>& done, core::Time end) {
  bool is_done = false;
  const auto check = [&] { return is_done = is_done || done(); };
  while (!io_.stopped() && !is_done) {
    io_.poll();
    if (io_.stopped() || !all_wait() || check()) continue;
    if (ring_.now() >= end) return false;
    advance(std::min({end, lockstep_.next_wake(), lockstep_.held_at()}), check);
  }
  return is_done;
}

bool VirtualRingHost::all_wait() {
  if (lockstep_.somebody_acts()) {
    lockstep_.await_messages();
    return false;
  }
  lockstep_.take_news();
  ring_.run_until(ring_.now());  // what was asked for in this instant
  if (lockstep_.take_news()) return false;
  // Who comes or ends in this instant does so when the machine gets to it: nobody has a turn before, so that the order
  // is always the same.
  if (lockstep_.held_at() <= ring_.now()) {
    if (!lockstep_.attach_those_due()) sleep_until(steady_clock::now() + kTick);
    return false;
  }
  if (!lockstep_.give_turns()) return true;
  lockstep_.await_messages();
  return false;
}

// Stops early when there are messages for a program: they must be delivered before the next instant.
void VirtualRingHost::advance(core::Time until, const std::function<bool()>& done) {
  const auto end = steady_clock::now() + kTurn;
  unsigned instants = 0;
  const auto over = [&] {
    if (lines_changed_) look_at_lines();
    return done() || lockstep_.has_news_now() || (++instants % kInstantsPerLook == 0 && steady_clock::now() >= end);
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
  if (drivers_[node] != nullptr) drivers_[node]->on_arrival(slice, now);
}

void VirtualRingHost::leaves(wire::NodeId node, const wire::Slice& slice, core::Time now) {
  if (drivers_[node] != nullptr) drivers_[node]->on_departure(slice, now);
}

void VirtualRingHost::input_changes(wire::NodeId, core::Line, core::Time) { lines_changed_ = true; }

void VirtualRingHost::incident(wire::NodeId, sim::Incident, core::Time, core::Line) { lines_changed_ = true; }

void VirtualRingHost::look_at_lines() {
  lines_changed_ = false;
  for (VirtualNode* driver : drivers_)
    if (driver != nullptr) driver->look_at_lines();
}

}  // namespace limb_ring::virtual_host
