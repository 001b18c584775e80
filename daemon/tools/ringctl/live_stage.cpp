#include "tools/ringctl/live_stage.h"

#include <algorithm>

#include "config/fault_parse.h"
#include "core/time.h"
#include "io/signal_wait.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/wait.h"

namespace limb_ring::ringctl {

using nlohmann::json;
using scenario::Fault;
using scenario::Scenario;
using scenario::Tally;
using std::chrono::milliseconds;
using wire::NodeId;

namespace {

constexpr milliseconds kBetweenLooks{20};
constexpr std::chrono::seconds kToJoin{30};  // of a closed ring on a busy machine

/// The value of E for which to_string() gives `word`; the first value if there is none.
template <class E>
E from_word(const std::string& word, E last) {
  for (unsigned i = 0; i <= static_cast<unsigned>(last); ++i)
    if (word == to_string(static_cast<E>(i))) return static_cast<E>(i);
  return E{};
}

/// A scenario's faults name nodes by their places in ring order.
fault::RingNodes nodes_by_place(const config::RingConfig& ring) {
  fault::RingNodes nodes;
  for (const config::NodeConfig& node : ring.nodes)
    nodes.push_back(
        {node.name, std::to_string(node.id), static_cast<NodeId>(nodes.size()), fault::host_name(ring, node)});
  return nodes;
}

}  // namespace

LiveStage::LiveStage(const Scenario& scenario, std::uint64_t seed, const RingPlan& plan, process::SignalWait& signals)
    : scenario_(scenario),
      plan_(plan),
      nodes_(plan, signals),
      senders_(scenario, nodes_, seed),
      random_(seed),
      first_rows_(plan.nodes.size()) {
  for (const NodeName& node : plan.nodes)
    boards_.push_back(std::make_unique<scenario_cpu::TakenBoard>(plan.ring, node.id));
  nodes_.on_message = [this](std::size_t place, const Message& message) { senders_.came(place, message); };
  nodes_.on_turn = [this] { return turn(); };
}

// ---- view -----------------------------------------------------------------------------------

core::NodeState LiveStage::state(NodeId id) const {
  return from_word(nodes_.row(id)->state, core::NodeState::duplicate_id);
}

unsigned LiveStage::ring_size(NodeId id) const { return nodes_.row(id)->ring_size.value_or(0); }

NodeId LiveStage::place_of(std::uint8_t id) const {
  const auto is = [&](const NodeName& node) { return node.id == id; };
  return static_cast<NodeId>(std::find_if(plan_.nodes.begin(), plan_.nodes.end(), is) - plan_.nodes.begin());
}

std::optional<wire::Beacon> LiveStage::heard(NodeId by, NodeId of) const {
  const status::NodeRow& row = *nodes_.row(by);
  const auto is = [&](const status::Heard& peer) { return place_of(peer.id) == of; };
  const auto peer = std::find_if(row.heard.begin(), row.heard.end(), is);
  if (peer == row.heard.end()) return std::nullopt;
  wire::Beacon beacon = peer->beacon;
  const auto& broken = row.broken_line;  // only the node behind a break announces it in its beacons
  beacon.break_known = broken && place_of(broken->behind) == of;
  if (beacon.break_known) beacon.break_before = place_of(broken->before);
  beacon.break_behind = of;
  return beacon;
}

std::uint64_t LiveStage::counter(NodeId id, const std::string& name) const {
  if (!alive(id)) return 0;
  const status::NodeRow& row = *nodes_.row(id);
  const auto& first = first_rows_[id];
  return row.counter(name) - (first && first->pid == row.pid ? first->counter(name) : 0);
}

const Tally& LiveStage::tally(const std::string& send) const {
  with_taken_ = senders_.tally(send);
  for (const auto& board : boards_) with_taken_.taken += board->of(senders_.mark_of(send));
  return with_taken_;
}

// ---- time -----------------------------------------------------------------------------------

std::vector<std::size_t> LiveStage::present() const {
  std::vector<std::size_t> places;
  for (std::size_t place = 0; place < nodes_.size(); ++place)
    if (std::count(scenario_.absent.begin(), scenario_.absent.end(), place) == 0) places.push_back(place);
  return places;
}

std::string LiveStage::first_not_ready() const {
  const std::vector<std::size_t> places = present();
  for (const std::size_t place : places) {
    const status::NodeRow* row = nodes_.row(place);
    const std::string lack = row ? lack_of_node(*row, places.size()) : "it does not answer yet";
    if (!lack.empty()) return "node " + label(plan_.nodes[place]) + ": " + lack + nodes_.last_lines(place);
  }
  return "";
}

std::optional<scenario::Stage::Failure> LiveStage::begin() {
  start_ = Clock::now();
  for (const std::size_t place : present()) nodes_.start(place);
  std::string lack;
  const auto ready = [&] { return broken_ || (lack = first_not_ready()).empty(); };
  run_until(ready, kToJoin, "every node joins");
  start_ = Clock::now();
  for (std::size_t place = 0; place < nodes_.size(); ++place)
    if (const status::NodeRow* row = nodes_.row(place)) first_rows_[place] = *row;
  if (broken_) return broken_;
  if (!lack.empty()) return Failure{"every node joins within " + std::to_string(kToJoin.count()) + " s", lack};
  return std::nullopt;
}

bool LiveStage::run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) {
  const auto end = start_ + std::chrono::ceil<Clock::duration>(until);
  Progress progress;
  for (;;) {
    const bool last = Clock::now() >= end;
    poll();
    if (done()) return true;
    if (last) return false;
    progress.tell(scenario_.name + ": " + what);
    nodes_.pump(std::min(Clock::now() + kBetweenLooks, end));
  }
}

void LiveStage::poll() {
  if (broken_) return;
  const auto dead = nodes_.exit_reason();
  const std::string problem = dead ? *dead : nodes_.poll();
  if (!problem.empty()) broken_ = Failure{"every daemon runs and does as it is told", problem};
}

LiveStage::Clock::time_point LiveStage::turn() {
  auto next = senders_.act();
  const auto now = Clock::now();
  for (auto it = endings_.begin(); it != endings_.end();) {
    if (it->when > now) {
      next = std::min(next, it++->when);
      continue;
    }
    end(*it);
    it = endings_.erase(it);
  }
  return next;
}

void LiveStage::end(const Ending& ending) {
  if (lasting_.number(ending.of, ending.node) != ending.number) return;
  if (fault::word_of(ending.of).of == fault::Of::node)
    nodes_.thaw(ending.node);
  else
    senders_.set_silent(ending.node, ending.of, false);
}

// ---- actions --------------------------------------------------------------------------------

std::optional<scenario::Stage::Failure> LiveStage::apply(const Fault& fault) {
  try {
    do_it(fault);
    return std::nullopt;
  } catch (const NotDone& problem) {
    return Failure{"the ring does it", problem.what()};
  }
}

void LiveStage::do_it(const Fault& fault) {
  const fault::Of of = fault::word_of(fault.name).of;
  // All are off before the first is on again.
  if (fault.name == fault::Name::power_cycle)
    for (const NodeId id : fault.nodes) nodes_.kill(id);
  for (const NodeId id : fault.nodes) {
    if (of != fault::Of::line) lasting_.begins(fault.name, id);
    if (of == fault::Of::node)
      apply_to_node(fault.name, id);
    else
      apply_at_daemon(fault, id);
  }
  // The daemon ends all else.
  if ((of != fault::Of::node && !fault::word_of(fault.name).silences) || fault.lasts.count() == 0) return;
  for (const NodeId id : fault.nodes)
    endings_.push_back({Clock::now() + fault.lasts, fault.name, id, lasting_.number(fault.name, id)});
}

void LiveStage::apply_to_node(fault::Name name, std::size_t place) {
  using fault::Node;
  if (name == fault::Name::power_cycle) name = fault::Name::start;  // it was killed just now
  const Node before = nodes_.dead(place) ? Node::dead : nodes_.running(place) ? Node::runs : Node::frozen;
  const auto now = fault::after(name, before);
  if (!now) return;
  switch (*now) {
    case Node::frozen:
      return nodes_.freeze(place);
    case Node::dead:
      nodes_.kill(place);
      break;
    case Node::runs:
      if (before == Node::frozen) return nodes_.thaw(place);
      nodes_.start(place);
  }
  senders_.set_whole(place);
}

/// As with models of CPUs: nothing happens to a CPU that is not there.
bool LiveStage::is_not_there(fault::Name name, std::size_t place) {
  if (fault::word_of(name).of != fault::Of::cpu) return false;
  if (nodes_.dead(place)) return true;
  if (!fault::hits_process(name) || !nodes_.running(place) || !nodes_.port(place)) return false;
  return nodes_.ask(place, {{"do", "status"}}).at("cpu").at("pid").is_null();
}

void LiveStage::apply_at_daemon(Fault fault, std::size_t place) {
  using fault::Name;
  if (is_not_there(fault.name, place)) return;
  fault.nodes = {static_cast<NodeId>(place)};
  if ((fault::word_of(fault.name).keys & fault::kSeed) != 0 && fault.seed == 0) fault.seed = random_() % 1000000 + 1;
  if (fault::word_of(fault.name).silences) senders_.set_silent(place, fault.name, true);
  const json request{{"do", "fault"}, {"fault", fault::to_words(fault, nodes_by_place(scenario_.ring))}};
  // Under the virtual clock too the scenario goes on while the CPU boots.
  if (fault.name == Name::reset || !nodes_.running(place) || !nodes_.port(place))
    nodes_.request(place, request);
  else
    nodes_.ask(place, request);
  for (const fault::Word& word : fault::kWords)
    if ((word.ended_by & bit_of(fault.name)) != 0) senders_.set_silent(place, word.name, false);
}

using scenario::Send;
using scenario::Step;

LiveSenders::LiveSenders(const Scenario& scenario, LiveNodes& nodes, std::uint64_t seed)
    : scenario_(scenario), nodes_(nodes), random_(seed), silenced_by_(nodes.size(), 0) {
  for (const Step& step : scenario.steps) {
    const auto* send = std::get_if<Send>(&step.action);
    if (send && std::find(names_.begin(), names_.end(), send->name) == names_.end()) names_.push_back(send->name);
  }
  tallies_.resize(names_.size());
}

std::uint8_t LiveSenders::mark_of(const std::string& send) const {
  return static_cast<std::uint8_t>(std::find(names_.begin(), names_.end(), send) - names_.begin());
}

std::uint8_t LiveSenders::id_of(std::uint8_t place_or_all) const {
  return place_or_all == wire::kBroadcast ? kBroadcast : scenario_.ring.nodes[place_or_all].id;
}

void LiveSenders::set_silent(std::size_t place, fault::Name by, bool silent) {
  if (silent) silenced_by_[place] |= bit_of(by);
  if (!silent) silenced_by_[place] &= ~bit_of(by);
}

// ---- what is sent ---------------------------------------------------------------------------

void LiveSenders::begin(const Send& send) {
  for (const auto from : send.from) {
    Job& job = jobs_.emplace_back(Job{send, from, mark_of(send.name), send.times(), Clock::now()});
    if (send.is_stream())
      job.due += std::chrono::nanoseconds(random_() % static_cast<std::uint64_t>(send.every.count()));
    else
      while (job.left != 0) ask(job);
  }
}

LiveSenders::Clock::time_point LiveSenders::act() {
  const auto now = Clock::now();
  auto next = Clock::time_point::max();
  for (Job& job : jobs_) {
    if (now - job.due > process::Standstill::kLeast) job.due = now;  // this process or its machine stood still
    while (job.left != 0 && job.due <= now && job.waiting < kMostWaiting) {
      ask(job);
      job.due += job.send.every;
    }
    if (job.left != 0 && job.waiting < kMostWaiting) next = std::min(next, job.due);
  }
  return next;
}

bool LiveSenders::can_send(const Job& job) {
  if (!nodes_.running(job.from) || !nodes_.port(job.from)) return false;
  if (job.send.input) return true;
  const status::NodeRow* row = nodes_.row(job.from);
  const std::string cpu = row ? row->cpu.state : "";
  return silenced_by_[job.from] == 0 && (cpu == "running" || cpu == "silent");  // silent: it was hung a moment ago
}

void LiveSenders::ask(Job& job) {
  --job.left;
  if (!can_send(job)) return;
  const auto at = Clock::now();
  asked_[{job.from, ask(*nodes_.port(job.from), job)}] = {&job, at};
  ++job.waiting;
}

std::uint32_t LiveSenders::ask(HostPort& port, const Job& job) {
  const Send& send = job.send;
  if (send.input) {
    if (const auto& wire = scenario_.ring.nodes[job.from].inputs[*send.input])
      of_interrupt_[{port.id(), wire->factor}] = job.mark;
    return port.pull(*send.input);
  }
  if (send.interrupt) {
    of_interrupt_[{port.id(), *send.interrupt}] = job.mark;
    return port.interrupt(id_of(send.to), *send.interrupt, /*force=*/true);
  }
  return port.send(id_of(send.to), std::vector<std::uint8_t>(send.size, job.mark), send.priority);
}

// ---- what becomes of it ---------------------------------------------------------------------

void LiveSenders::came(std::size_t place, const Message& message) {
  if (const auto* result = std::get_if<Result>(&message)) came(place, *result);
  if (const auto* seen = std::get_if<Observed>(&message)) came(*seen);
}

void LiveSenders::came(std::size_t place, const Result& result) {
  const auto found = asked_.find({place, result.token});
  if (found == asked_.end()) return;
  const auto [job, at] = found->second;
  asked_.erase(found);
  --job->waiting;
  Tally& tally = tallies_[job->mark];
  ++tally.results[static_cast<std::size_t>(result.outcome)];
  if (result.outcome == Outcome::delivered) tally.worst = std::max<core::Duration>(tally.worst, Clock::now() - at);
}

void LiveSenders::came(const Observed& seen) {
  const json pin = json::parse(seen.json);
  const auto found = of_interrupt_.find({pin.value("source", std::uint8_t{0}), pin.value("factor", std::uint8_t{0})});
  if (pin.value("kind", "") == "pin" && found != of_interrupt_.end()) ++tallies_[found->second].taken;
}

}  // namespace limb_ring::ringctl
