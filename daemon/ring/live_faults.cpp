#include "ring/live_faults.h"

#include <algorithm>
#include <thread>

#include "config/quantity.h"
#include "io/in_parallel.h"
#include "ring/ring_client.h"

namespace limb_ring::live {

using fault::Fault;
using fault::Name;
using fault::Of;
using nlohmann::json;

namespace {

const char* const kKill = fault::word_of(Name::kill).word;

constexpr std::chrono::milliseconds kEndTick{50};  ///< how soon somebody who asks to end is heard

bool sleeps(std::chrono::milliseconds time) {
  std::this_thread::sleep_for(time);
  return false;
}

struct Problem {
  std::string what;        ///< empty: none
  bool no_daemon = false;  ///< it does not answer, or does not run
};

/// Acts on all nodes at once, so that they break together and the waits overlap.
std::vector<Problem> at_the_same_time(const std::vector<wire::NodeId>& nodes,
                                      const std::function<void(std::size_t)>& act) {
  std::vector<Problem> problems(nodes.size());
  process::in_parallel(nodes.size(), nodes.size(), [&](std::size_t i) {
    try {
      act(i);
    } catch (const HostPortError& error) {
      problems[i] = {error.what(), true};
    } catch (const std::exception& error) {
      problems[i] = {error.what()};
    }
  });
  return problems;
}

/// @throw NotDone with all of them, if there is one; HostPortError if none is of another kind
void require_all(const std::vector<Problem>& problems) {
  std::string wrong;
  bool no_daemons = true;
  for (const Problem& problem : problems) {
    if (problem.what.empty()) continue;
    wrong += (wrong.empty() ? "" : "; ") + problem.what;
    no_daemons = no_daemons && problem.no_daemon;
  }
  if (wrong.empty()) return;
  if (no_daemons) throw HostPortError(wrong);
  throw NotDone(wrong);
}

fault::ParseError no_id(const std::string& id) {
  return {"no fault can have the id '" + fault::shown(id) + "'",
          "NODE.NUMBER, NODE.kill, NODE.freeze and NODE.suspend, as the list of faults shows"};
}

/// Of a whole node, and lasts.
bool is_noted(Name fault) { return fault == Name::kill || fault::freezes(fault); }

Fault for_one(Fault fault, wire::NodeId node) {
  fault.nodes = {node};
  return fault;
}

}  // namespace

// ---- beginning ------------------------------------------------------------------------------

std::vector<Begun> LiveFaults::begin(const Fault& fault, const Wait& given) const {
  const Wait wait = given ? given : Wait(sleeps);
  if (fault.name == Name::step_clock && !daemons_.is_virtual())
    throw NotDone(
        "step_clock: live, the clocks are those of the machine; use 'ringctl up --clock virtual', or a "
        "scenario under the virtual clock");
  if (fault::word_of(fault.name).of == Of::node && daemons_.is_virtual()) return begin_on_virtual_ring(fault, wait);
  std::vector<Begun> begun(fault.nodes.size());
  require_all(at_the_same_time(fault.nodes, [&](std::size_t i) { begun[i] = begin_at(fault, fault.nodes[i], wait); }));
  return begun;
}

// The virtual ring does it to all nodes at one instant, keeps the notes, and thaws by its own clock.
std::vector<Begun> LiveFaults::begin_on_virtual_ring(const Fault& fault, const Wait& wait) const {
  if (fault.name == Name::thaw) daemons_.wake_ring();
  daemons_.ask_ring({{"do", "fault"}, {"fault", fault::to_words(fault, daemons_.nodes())}});
  const bool comes_up = fault.name == Name::start || fault.name == Name::power_cycle;
  const bool ends = fault::freezes(fault.name) && fault.lasts.count() != 0;
  require_all(at_the_same_time(fault.nodes, [&](std::size_t i) {
    if (comes_up) daemons_.wait_for_hello(fault.nodes[i]);
    if (ends) wait_until_thawed(fault.nodes[i], wait);
  }));
  const bool lasts = is_noted(fault.name) && !ends;
  std::vector<Begun> begun;
  for (const wire::NodeId node : fault.nodes) {
    const std::string id = daemons_.node(node).name + '.' + fault::word_of(fault.name).word;
    begun.push_back({lasts ? id : "", fault::to_words(for_one(fault, node), daemons_.nodes())});
  }
  return begun;
}

Begun LiveFaults::begin_at(const Fault& fault, wire::NodeId node, const Wait& wait) const {
  if (fault::word_of(fault.name).of != Of::node) return begin_at_daemon(fault, node);
  const std::string words = fault::to_words(for_one(fault, node), daemons_.nodes());
  if (!is_noted(fault.name)) return begin_at_node(fault, node), Begun{"", words};
  const NodeNote note = begin_noted(fault.name, node, words);
  if (fault.lasts.count() == 0) return {daemons_.node(node).name + '.' + fault::word_of(fault.name).word, words};
  wait_and_thaw(fault.lasts, node, note, wait);
  return {"", words};
}

NodeNote LiveFaults::note(wire::NodeId node, const std::string& words) const {
  const std::string problem = write_note(daemons_.folder(), node, words);
  if (!problem.empty()) throw NotDone("node " + daemons_.node(node).name + ": " + problem);
  return note_of(daemons_.folder(), node).value_or(NodeNote{});
}

// The note is written before, so that 'ringctl up --respawn' finds a kill however soon it looks, and nothing lasts that
// nobody can list. It is written again after, because clearing all faults meanwhile removes one that does not hold yet.
NodeNote LiveFaults::begin_noted(Name what, wire::NodeId node, const std::string& words) const {
  const auto former = note_of(daemons_.folder(), node);
  note(node, words);
  try {
    what == Name::kill ? daemons_.kill(node) : daemons_.freeze(node);
  } catch (const std::exception&) {
    remove_note(daemons_.folder(), node);
    if (former) note(node, former->words);
    throw;
  }
  return note(node, words);
}

void LiveFaults::begin_at_node(const Fault& fault, wire::NodeId node) const {
  if (fault.name == Name::thaw) daemons_.thaw(node);
  if (fault.name == Name::start) daemons_.start(node);
  if (fault.name == Name::power_cycle) daemons_.power_cycle(node);
  remove_note(daemons_.folder(), node);  // last: without it 'ringctl up --respawn' would start a second daemon
}

// A frozen daemon cannot thaw itself, so the caller waits. The fault stays in the list meanwhile; if another one has
// taken its place, that one is not ours to end.
void LiveFaults::wait_and_thaw(std::chrono::nanoseconds lasts, wire::NodeId node, const NodeNote& ours,
                               const Wait& wait) const {
  const auto lasts_still = [&] {
    const auto note = note_of(daemons_.folder(), node);
    return note && note->words == ours.words && note->since == ours.since;
  };
  const auto end = std::chrono::steady_clock::now() + lasts;
  bool asked_to_end = false;
  while (!asked_to_end && lasts_still() && std::chrono::steady_clock::now() < end) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    asked_to_end = wait(std::min(left, kEndTick));
  }
  if (lasts_still() && node_fault(node)) revive(node);
}

// Polled without a deadline: the ring's time may be slow or paused.
void LiveFaults::wait_until_thawed(wire::NodeId node, const Wait& wait) const {
  while (daemons_.is_frozen(node))
    if (wait(std::chrono::milliseconds(5))) return daemons_.thaw(node);
}

Begun LiveFaults::begin_at_daemon(const Fault& fault, wire::NodeId node) const {
  const std::string words = fault::to_words(for_one(fault, node), daemons_.nodes());
  const json request{{"do", "fault"}, {"fault", words}};
  const json answer = fault.name == Name::reset ? daemons_.ask_for_boot(node, request) : daemons_.ask(node, request);
  const auto id = answer.at("id").get<std::uint32_t>();
  const std::string name = id == 0 ? std::string{} : daemons_.node(node).name + '.' + std::to_string(id);
  return {name, answer.at("fault").get<std::string>()};
}

// ---- what there is --------------------------------------------------------------------------

std::optional<status::Fault> noted_fault(const std::string& folder, wire::NodeId node) {
  const auto note = note_of(folder, node);
  if (!note || !(note->name() == kKill ? is_killed(folder, node) : is_frozen(folder, node))) return std::nullopt;
  status::Fault fault;
  fault.id.text = fault.name = note->name();
  fault.fault = note->words;
  fault.age_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - note->since).count();
  fault.hits = 1;
  return fault;
}

std::optional<status::Fault> LiveFaults::node_fault(wire::NodeId node) const {
  auto fault = noted_fault(daemons_.folder(), node);
  if (fault) fault->id.text.insert(0, daemons_.node(node).name + '.');
  return fault;
}

std::vector<status::Fault> LiveFaults::faults_of(wire::NodeId node) const {
  if (auto of_node = node_fault(node)) return {*of_node};
  if (!daemons_.holder(node).held) return {};
  std::vector<status::Fault> faults;
  const std::string wrong = status::read(daemons_.ask(node, {{"do", "faults"}}).at("faults"), faults);
  if (!wrong.empty()) throw NotDone("node " + daemons_.node(node).name + ": " + ask::sentence_of_shape(wrong));
  for (status::Fault& fault : faults) fault.id.text.insert(0, daemons_.node(node).name + '.');
  return faults;
}

FaultList LiveFaults::list() const {
  const std::vector<wire::NodeId> ids = daemons_.node_ids();
  std::vector<std::vector<status::Fault>> found(ids.size());
  const auto problems = at_the_same_time(ids, [&](std::size_t i) { found[i] = faults_of(ids[i]); });
  FaultList all;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    all.faults.insert(all.faults.end(), found[i].begin(), found[i].end());
    if (!problems[i].what.empty())
      all.unknown.push_back("the faults at " + daemons_.node(ids[i]).name + " are not known: " + problems[i].what);
  }
  return all;
}

// ---- the end --------------------------------------------------------------------------------

wire::NodeId LiveFaults::node_of(const std::string& id) const {
  const std::string name = id.substr(0, id.rfind('.'));
  for (const auto& node : daemons_.nodes())
    if (name == node.name || name == node.number) return node.id;
  throw no_id(id);
}

void LiveFaults::remove(const std::string& id) const {
  const std::size_t dot = id.rfind('.');
  if (dot == std::string::npos) throw no_id(id);
  const wire::NodeId node = node_of(id);
  const std::string rest = id.substr(dot + 1);
  if (const fault::Word* word = fault::find_word(rest); word != nullptr && is_noted(word->name)) {
    const auto fault = node_fault(node);
    if (fault && fault->name == rest) return revive(node);
    throw NotDone("node " + daemons_.node(node).name + " has no fault " + rest + " (any more)");
  }
  if (!config::are_digits(rest, 9)) throw no_id(id);
  daemons_.ask(node, {{"do", "remove_fault"}, {"id", std::stoul(rest)}});
}

void LiveFaults::revive(wire::NodeId node, std::chrono::milliseconds patience) const {
  if (daemons_.is_frozen(node)) daemons_.thaw(node);
  if (!daemons_.holder(node).held) daemons_.start(node, patience);
  remove_note(daemons_.folder(), node);
}

void LiveFaults::clear_at(wire::NodeId node, std::chrono::milliseconds patience) const {
  if (!daemons_.holder(node).held && !node_fault(node)) return;  // it does not run, and we did not kill it
  revive(node, patience);
  daemons_.ask(node, {{"do", "clear_faults"}});
}

std::vector<std::string> LiveFaults::clear(std::chrono::milliseconds patience) const {
  if (daemons_.is_virtual()) daemons_.wake_ring();
  const std::vector<wire::NodeId> ids = daemons_.node_ids();
  std::vector<std::string> problems;
  for (const Problem& problem : at_the_same_time(ids, [&](std::size_t i) { clear_at(ids[i], patience); }))
    if (!problem.what.empty()) problems.push_back(problem.what);
  return problems;
}

}  // namespace limb_ring::live
