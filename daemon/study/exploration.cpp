#include "study/exploration.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

#include "config/quantity.h"
#include "io/in_parallel.h"
#include "sim/virtual_line_faults.h"

namespace limb_ring::study {

using core::Line;
using wire::NodeId;
using namespace std::chrono_literals;

namespace {

constexpr auto kLasts = 3ms;      ///< a freeze, a cut: longer than it takes to find either
constexpr auto kLongest = 100ms;  ///< until all sends have ended, which takes 20 ms for one that cannot leave
constexpr auto kBreaking = 20ms;  ///< until all know of a break
constexpr auto kSettling =
    3ms;  ///< after a strike in a broken ring: who restarts beside the break waits for its mending
constexpr auto kMending = 60ms;
constexpr auto kSilence = 10ms;

}  // namespace

ExploredRun::ExploredRun(const World& world, std::vector<Choice> choices)
    : world_(world), choices_(std::move(choices)) {
  make_ring();
}

void ExploredRun::make_ring() {
  sim::VirtualRingOptions options;
  options.nodes = world_.nodes;
  options.byte_time = world_.paced ? core::Duration{8ns} : core::Duration{0};
  options.keep_logs = false;
  options.adjust = [this](core::Settings& s) { sim::set_short_times(s, world_.paced, world_.fold_back); };
  ring_ = std::make_unique<sim::VirtualRing>(options);
  invariants_ = std::make_unique<sim::Invariants>(*ring_);
  lines_ = std::make_unique<sim::VirtualLineFaults>(*ring_, 1);
  ring_->on_event = [this](NodeId id, const core::Event& event) {
    const auto* end = std::get_if<core::SendEnded>(&event.what);
    if (end != nullptr && waiting_[id] != 0) --waiting_[id];
  };
  for (const NodeId id : ring_->order())
    for (const Line line : ring_->lines())
      ring_->tap(
          id,
          [this, id, line](const wire::Slice& slice, core::Time, wire::SliceWriter& arriving) {
            pass(id, line, slice, arriving);
          },
          line);
}

void ExploredRun::run() {
  ring_->join();
  if (world_.broken) break_ring();
  for (unsigned nth = 0; nth < world_.sends; ++nth) ask(nth);
  open_ = true;
  ring_->run_until([this] { return is_over(); }, kLongest);
  open_ = false;
  recognised_ = recognised_ || meets_known_state();
  if (recognised_) return;
  if (world_.broken) heal(world_.last_node());
  ring_->run_for(kMending);
  invariants_->finish();
  note_violation();
  if (!violation_) violation_ = sim::not_whole(*ring_);
  quiet_ = true;
  if (!violation_) ring_->run_for(kSilence);
  if (!violation_) note_violation();
  if (!violation_) violation_ = sim::not_silent(*ring_, slices_when_quiet_);
}

void ExploredRun::break_ring() {
  world_.fold_back ? ring_->cut_cable(world_.last_node()) : ring_->cut(world_.last_node());
  ring_->run_until([this] { return is_settled(); }, kBreaking);
}

bool ExploredRun::is_over() {
  if (invariants_->violation()) return true;
  recognised_ = left_ != 0 && places_ != compared_at_ && meets_known_state();
  const bool all_ended = std::all_of(waiting_.begin(), waiting_.end(), [](unsigned sends) { return sends == 0; });
  return recognised_ || (all_ended && mendings_.empty() && (is_settled() || ring_->now() >= settled_by_));
}

// The hash does not contain what a faulty line holds back, so no state is recognised while a line holds anything.
bool ExploredRun::meets_known_state() {
  const bool all_struck = struck_ == choices_.size() && !strikes_now_;
  if (states_ == nullptr || !all_struck || invariants_->violation() || !lines_->at_rest()) return false;
  compared_at_ = places_;
  return states_->meet(state_hash(), run_, left_);
}

std::uint64_t ExploredRun::state_hash() {
  StateHash hash(world_.nodes, ring_->now());
  hash("ring", *ring_)("invariants", *invariants_)("waiting", waiting_)("mendings", mendings_);
  hash("settled_by", settled_by_);
  return hash.value();
}

/// All nodes are in the state that the ring has when nothing has struck.
bool ExploredRun::is_settled() const {
  using core::NodeState;
  const NodeState without_a_line = world_.fold_back ? NodeState::folded : NodeState::open_chain;
  const NodeState state = world_.broken ? without_a_line : NodeState::up;
  return std::all_of(ring_->order().begin(), ring_->order().end(), [&](NodeId id) {
    const core::Membership& m = ring_->controller(id).membership();
    return ring_->alive(id) && m.state() == state && (world_.broken || m.ring_size() == world_.nodes);
  });
}

void ExploredRun::settle_later() {
  if (world_.broken) settled_by_ = ring_->now() + kSettling;
}

void ExploredRun::ask(unsigned nth) {
  const NodeId source = ring_->order()[nth % world_.nodes];
  ++waiting_[source];
  const NodeId before = core::node_after(ring_->order(), source, world_.nodes - 1);
  const NodeId destination = nth % 2 == 0 ? before : NodeId{wire::kBroadcast};
  ring_->send(source, destination, std::vector<std::uint8_t>(7, static_cast<std::uint8_t>(nth)),
              static_cast<std::uint8_t>(nth % 4));
}

// ---- strikes --------------------------------------------------------------------------------

void ExploredRun::pass(NodeId id, Line line, const wire::Slice& slice, wire::SliceWriter& arriving) {
  if (quiet_ && sim::is_traffic(slice)) ++slices_when_quiet_;
  if (!open_) return lines_->pass(id, line, slice, arriving);
  const unsigned place = places_++;
  if (struck_ == choices_.size() || choices_[struck_].place != place) return lines_->pass(id, line, slice, arriving);
  strike(choices_[struck_++].strike, id, line, slice, arriving);
}

void ExploredRun::strike(const Strike& what, NodeId id, Line line, const wire::Slice& slice,
                         wire::SliceWriter& arriving) {
  switch (what.kind) {
    case Strike::Kind::lost:
      return;
    case Strike::Kind::header_damaged:
      return damage(0, id, line, slice, arriving);
    case Strike::Kind::data_damaged:
      return damage(slice.bytes.size / 2, id, line, slice, arriving);
    case Strike::Kind::end_damaged:
      return damage(slice.bytes.size - 1, id, line, slice, arriving);
    case Strike::Kind::doubled:
      begin_line_fault(fault::Name::duplicate, id, line);
      break;
    case Strike::Kind::late:
      begin_line_fault(fault::Name::stall, id, line);
      break;
    default:  // in this very instant, once the slice is on its way
      strikes_now_ = true;
      ring_->at(ring_->now(), [this, what] { strike_node(what); });
  }
  lines_->pass(id, line, slice, arriving);
}

void ExploredRun::damage(std::size_t at, NodeId id, Line line, const wire::Slice& slice, wire::SliceWriter& arriving) {
  if (slice.bytes.empty()) return lines_->pass(id, line, slice, arriving);
  lines_->pass_damaged(id, line, slice, at, 0x10, arriving);
}

// No copy may outlive the time-out of a try, so a line holds back for a part of it only. (protocol.md section 6.1)
void ExploredRun::begin_line_fault(fault::Name name, NodeId id, Line line) {
  const auto longest = ring_->settings(id).send_timeout() / 32;
  fault::Fault fault;
  fault.name = name;
  fault.nodes = {id};
  fault.second_line = line == Line::second;
  fault.once_in = 1;
  fault.packets = name == fault::Name::duplicate ? 1 : 0;
  fault.delay = fault.lasts = core::whole_nanoseconds(longest);
  lines_->begin(fault);
}

void ExploredRun::strike_node(const Strike& what) {
  const NodeId node = what.node;
  strikes_now_ = false;
  settle_later();
  switch (what.kind) {
    case Strike::Kind::restart:
      return restart(node);
    case Strike::Kind::freeze:
      return freeze(node);
    case Strike::Kind::cut:
      return cut(node);
    default:
      if (!ring_->alive(node)) return;
      ++waiting_[node];
      ring_->interrupt(node, core::node_after(ring_->order(), node, 1), 2);
  }
}

// The node's open sends are lost with it and never end, so they are not waited for.
void ExploredRun::restart(NodeId node) {
  if (ring_->alive(node)) ring_->kill(node);
  waiting_[node] = 0;
  ring_->start(node);
}

void ExploredRun::freeze(NodeId node) {
  if (!ring_->alive(node)) return;
  ring_->freeze(node);
  mend_later(Strike::Kind::freeze, node);
}

void ExploredRun::cut(NodeId node) {
  world_.fold_back ? ring_->cut_cable(node) : ring_->cut(node);
  mend_later(Strike::Kind::cut, node);
}

void ExploredRun::heal(NodeId node) { world_.fold_back ? ring_->heal_cable(node) : ring_->heal(node); }

void ExploredRun::mend_later(Strike::Kind of, NodeId node) {
  mendings_.push_back({ring_->now() + kLasts, of, node});
  ring_->at(mendings_.back().at, [this] { mend(); });
}

// All last equally long, so the first that began is the first to end.
void ExploredRun::mend() {
  const Mending due = mendings_.front();
  mendings_.pop_front();
  settle_later();
  due.of == Strike::Kind::freeze ? ring_->thaw(due.node) : heal(due.node);
}

namespace {

constexpr std::array<const char*, 10> kWords{"lost", "header-damaged", "data-damaged", "end-damaged", "doubled",
                                             "late", "restart",        "freeze",       "cut",         "interrupt"};

/// A whole number of at most 6 digits. @throw std::invalid_argument
unsigned number_from(const std::string& text, const std::string& part) {
  if (config::are_digits(text, 6)) return static_cast<unsigned>(std::stoul(text));
  throw std::invalid_argument("'" + part + "': '" + text +
                              "' is not a whole number from 0 to 999999, as in 12:lost or 20:restart:1");
}

Choice choice_from(const std::string& part) {
  std::istringstream in(part);
  std::string place, word, node;
  std::getline(in, place, ':');
  std::getline(in, word, ':');
  std::getline(in, node);
  Choice choice;
  choice.place = number_from(place, part);
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    if (word != kWords[i]) continue;
    choice.strike.kind = static_cast<Strike::Kind>(i);
    if (choice.strike.is_of_node() == node.empty())
      throw std::invalid_argument("'" + part + "': " + word +
                                  (node.empty() ? " needs a node, as in 20:restart:1" : " is of no node"));
    if (!node.empty()) choice.strike.node = static_cast<wire::NodeId>(number_from(node, part));
    return choice;
  }
  std::string allowed;
  for (const char* known : kWords) allowed += std::string(allowed.empty() ? "" : ", ") + known;
  throw std::invalid_argument("'" + part + "': '" + word + "' is not one of " + allowed);
}

}  // namespace

const char* to_string(Strike::Kind kind) { return kWords[static_cast<std::size_t>(kind)]; }

std::string to_text(const std::vector<Choice>& choices) {
  std::string text;
  for (const Choice& choice : choices) {
    text += (text.empty() ? "" : ",") + std::to_string(choice.place) + ":" + to_string(choice.strike.kind);
    if (choice.strike.is_of_node()) text += ":" + std::to_string(choice.strike.node);
  }
  return text;
}

std::vector<Choice> choices_from(const std::string& text) {
  std::vector<Choice> choices;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    const Choice choice = choice_from(part);
    if (!choices.empty() && choice.place <= choices.back().place)  // its place would be over
      throw std::invalid_argument("'" + part + "': its place is not behind that of the one before it");
    choices.push_back(choice);
  }
  return choices;
}

// Each thread takes one first strike after another and explores everything that can follow it.
void Exploration::run(const Progress& progress) {
  const std::vector<Choice> firsts = next({}, run_once({}, progress));
  process::in_parallel(firsts.size(), bounds_.threads, [&](std::size_t i) {
    if (stop_) return;
    std::vector<Choice> choices{firsts[i]};
    extend(choices, progress);
  });
}

void Exploration::extend(std::vector<Choice>& choices, const Progress& progress) {
  for (const Choice& choice : next(choices, run_once(choices, progress))) {
    if (stop_) return;
    choices.push_back(choice);
    extend(choices, progress);
    choices.pop_back();
  }
}

// If places are bounded, two runs in the same state may be at different places, so that more can still strike in one of
// them. Then states are recognised only once nothing more may strike. @return places in that run
unsigned Exploration::run_once(const std::vector<Choice>& choices, const Progress& progress) {
  ExploredRun run(world_, choices);
  const bool bounded = bounds_.places < kAllPlaces;
  const auto left = bounded ? 0 : bounds_.faults - static_cast<unsigned>(choices.size());
  if (bounds_.recognise) run.recognise(states_, ++begun_, left);
  run.run();
  const std::lock_guard<std::mutex> lock(mutex_);
  ++runs_;
  recognised_ += run.recognised() ? 1 : 0;
  places_ = std::max(places_, run.places());
  if (run.violation() && !found_) found_ = Found{choices, *run.violation()};
  if (found_) stop_ = true;
  progress();
  return run.places();
}

/// What may strike next in such a run.
std::vector<Choice> Exploration::next(const std::vector<Choice>& choices, unsigned places) const {
  std::vector<Choice> all;
  if (choices.size() == bounds_.faults || stop_) return all;
  for (unsigned place = choices.empty() ? 0 : choices.back().place + 1; place < std::min(places, bounds_.places);
       ++place)
    for (const Strike& strike : strikes()) all.push_back({place, strike});
  return all;
}

// No doubling in a ring that folds back: a fold may bring the copy after its source's next packet, which the lines of a
// ring never do. And no cut where the ring is broken already.
std::vector<Strike> Exploration::strikes() const {
  using What = Strike::Kind;
  std::vector<Strike> all;
  for (const What kind :
       {What::lost, What::header_damaged, What::data_damaged, What::end_damaged, What::doubled, What::late})
    if (kind != What::doubled || !world_.fold_back) all.push_back({kind, wire::NodeId{0}});
  for (const What kind : {What::restart, What::freeze, What::cut, What::interrupt})
    for (unsigned node = 0; node < world_.nodes; ++node)
      if (kind != What::cut || !world_.broken || node != world_.last_node())
        all.push_back({kind, static_cast<wire::NodeId>(node)});
  return all;
}

}  // namespace limb_ring::study
