#include "tools/ringctl/fault.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <optional>

#include "config/fault_parse.h"
#include "config/ring_config.h"
#include "io/in_parallel.h"
#include "io/signal_wait.h"
#include "limb_ring/host_port.h"
#include "limb_ring/ring_directory.h"
#include "ring/live_faults.h"
#include "ring/ring_files.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/wait.h"

namespace limb_ring::ringctl {

using live::LiveFaults;
using nlohmann::json;

namespace {

constexpr const char* kFaultHelp =
    "A line is A:B or 'A -> B', from a node to the next. Quote the latter: '>' is the shell's. Each command returns "
    "when "
    "its fault has taken effect. The ROS service inject_fault and scenarios take the same words.";

struct FaultOptions {
  std::vector<std::string> where;
  std::map<std::string, std::string> parameters;  ///< by key (config/fault_parse.h)
  std::string id;
  double timeout_s = 20;
  bool json = false;
};

fault::RingNodes nodes_by_id(const RingAccess& ring) {
  fault::RingNodes nodes;
  for (const NodeName& node : ring.nodes())
    nodes.push_back({node.name, std::to_string(node.id), wire::NodeId{node.id}, node.host});
  return nodes;
}

std::string words_of(const fault::Word& word, const FaultOptions& options) {
  std::string words = word.word;
  for (const std::string& part : options.where) words += ' ' + part;
  for (const auto& [key, value] : options.parameters)
    if (!value.empty()) words += ' ' + key + '=' + value;
  return words;
}

/// "after_packets" -> "--after-packets"
std::string option_name(const std::string& key) {
  std::string name = "--" + key;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

/// What a user of a command line writes for a value that stands alone.
std::string option_for(const fault::BareWord& bare) {
  return bare.key.empty() ? "one line A:B, and options" : option_name(bare.key) + ' ' + bare.word;
}

fault::Fault parsed(const std::string& words, const fault::RingNodes& nodes, bool folds_back) {
  try {
    const fault::Fault fault = fault::from_words(words, nodes);
    fault::check_second_line(fault, folds_back, nodes);
    return fault;
  } catch (const fault::BareWord& bare) {
    throw UsageError(words + ": " + bare.problem + "; allowed: " + option_for(bare));
  } catch (const fault::MissingKey& missing) {
    std::vector<std::string> options;
    for (const std::string& key : missing.keys) options.push_back(option_name(key));
    throw UsageError(words + ": " + missing.fault + " needs " + config::join(options, " or ") +
                     "; allowed: " + missing.allowed);
  } catch (const fault::ParseError& error) {
    throw UsageError(words + ": " + error.what());
  }
}

/// Ctrl-C while a node is frozen for a time: it is thawed before ringctl ends. A fault of another kind is not waited
/// for, so there Ctrl-C does as ever.
class Interruption {
 public:
  explicit Interruption(const fault::Fault& fault) {
    if (fault::freezes(fault.name) && fault.lasts.count() != 0) signals_.emplace();
  }
  LiveFaults::Wait wait() {
    if (!signals_) return {};
    return [this](std::chrono::milliseconds time) {
      if (signals_->asked_to_end(time)) came_ = true;
      return came_.load();
    };
  }
  bool came() const { return came_; }

 private:
  std::optional<process::SignalWait> signals_;
  std::atomic<bool> came_{false};  // several nodes are waited for at the same time
};

int begin(const Context& context, const fault::Word& word, const FaultOptions& options) {
  // The user typed A -> B without quotes, so the shell has redirected the output to a file named B.
  if (!options.where.empty() && options.where.back() == "-")
    throw UsageError(std::string(word.word) + ": the shell has taken '>' for itself: write A:B, or quote 'A -> B'");
  const RingAccess ring = RingAccess::open_also_dead(choose_ring(context.ring));
  const fault::RingNodes nodes = nodes_by_id(ring);
  const fault::Fault fault = parsed(words_of(word, options), nodes, ring.folds_back());
  for (const wire::NodeId id : fault.nodes) ring.require_here(ring.node(std::to_string(id)));
  Interruption interruption(fault);
  BegunFaults faults;
  while_telling(ring.ring(), [&] { faults = begin_fault(ring.ring(), nodes, fault, interruption.wait()); });
  json all = json::array();
  for (const live::Begun& begun : faults.done) {
    all.push_back({{"id", begun.id.empty() ? json() : json(begun.id)}, {"fault", begun.words}});
    if (!options.json) std::cout << (begun.id.empty() ? "done" : begun.id) << ": " << begun.words << std::endl;
  }
  if (options.json) std::cout << all.dump(2) << std::endl;
  if (faults.problem) std::rethrow_exception(faults.problem);
  if (interruption.came()) throw NotDone("interrupted: thawed before its time");
  return kDone;
}

int list(const Context& context, const FaultOptions& options) {
  const RingAccess ring = RingAccess::open_also_dead(choose_ring(context.ring));
  tell_unreadable(ring_directory(ring.ring()));
  const live::FaultList list = LiveFaults(ring.ring(), nodes_by_id(ring)).list();
  if (options.json)
    std::cout << json{{"ring", ring.ring()}, {"faults", status::to_json(list.faults)}, {"unknown", list.unknown}}.dump(
                     2)
              << '\n';
  else if (!list.faults.empty())
    std::cout << fault_table(list.faults);
  else if (list.unknown.empty())
    std::cout << "ring " << ring.ring() << " has no faults on purpose\n";
  if (!options.json)
    for (const std::string& problem : list.unknown) tell_user(problem);
  return list.unknown.empty() ? kDone : kNotDone;
}

int remove(const Context& context, const FaultOptions& options) {
  const RingAccess ring = RingAccess::open_also_dead(choose_ring(context.ring));
  try {
    const std::size_t dot = options.id.rfind('.');
    if (dot != std::string::npos) ring.require_here(ring.node(options.id.substr(0, dot)));
    while_telling(ring.ring(), [&] { LiveFaults(ring.ring(), nodes_by_id(ring)).remove(options.id); });
  } catch (const fault::ParseError& error) {
    throw UsageError(error.what());
  }
  std::cout << "removed " << options.id << std::endl;
  return kDone;
}

int clear(const Context& context, const FaultOptions& options) {
  const RingAccess ring = RingAccess::open_also_dead(choose_ring(context.ring));
  const std::chrono::milliseconds timeout(std::llround(options.timeout_s * 1000));
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  std::vector<std::string> problems;
  while_telling(ring.ring(), [&] { problems = LiveFaults(ring.ring(), nodes_by_id(ring)).clear(timeout); });
  for (const std::string& problem : problems) tell_user(problem);
  if (!problems.empty()) return kNotDone;
  std::cout << "no faults are left in ring " << ring.ring() << std::endl;
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
  const std::string lacking = wait_for(ring.ring(), left, lack_of_whole);
  if (!lacking.empty()) throw NotDone("but it is not whole again: " + lacking);
  std::cout << "it is whole again: " << ring.nodes().size() << " nodes up" << std::endl;
  return kDone;
}

/// "how long a period is; a time such as 5ms or 200us, up to 3600s; required"
std::string help_of(const fault::KeyWord& key, const fault::Word& word) {
  const std::string text = std::string(key.meaning) + "; " + key.allowed;
  std::vector<std::string> needed;
  for (const fault::KeyWord& one : fault::needed_keys_of(word)) needed.push_back(option_name(one.word));
  if (std::find(needed.begin(), needed.end(), option_name(key.word)) == needed.end()) return text;
  return text + "; " + (needed.size() > 1 ? config::join(needed, " or ") + " is " : "") + "required";
}

/// "ringctl fault flap left_hip:left_knee --every 200ms"
std::string example_of(const fault::Word& word) {
  const std::map<fault::Key, std::string> values{
      {fault::kDelay, "5ms"}, {fault::kJitter, "5ms"}, {fault::kRate, "10Mbit/s"}, {fault::kEvery, "200ms"},
      {fault::kPackets, "3"}, {fault::kFor, "2s"},     {fault::kForward, "1s"}};
  std::string text = std::string("ringctl fault ") + word.word;
  text += word.of == fault::Of::line ? " left_hip:left_knee" : " left_knee";
  std::vector<fault::KeyWord> keys = fault::needed_keys_of(word);
  if (keys.empty()) keys = fault::keys_of(word);
  for (const fault::KeyWord& key : keys)
    if (const auto value = values.find(key.key); value != values.end())
      return text + ' ' + option_name(key.word) + ' ' + value->second;
  return text;
}

void add_word(CLI::App& faults, Context& context, const fault::Word& word) {
  auto options = std::make_shared<FaultOptions>();
  CLI::App* command = add_command(faults, word.word, word.meaning, example_of(word));
  const bool line = word.of == fault::Of::line;
  command->add_option("WHERE", options->where, line ? "One line, A:B" : "Nodes, ids or names, or all")
      ->required()
      ->type_name(line ? "A:B" : "NODE");
  for (const fault::KeyWord& key : fault::keys_of(word))
    command->add_option(option_name(key.word), options->parameters[key.word], help_of(key, word));
  add_json(*command, options->json);
  command->callback([&context, &word, options] {
    context.action = [&context, &word, options] { return begin(context, word, *options); };
  });
}

void add_keeping(CLI::App& faults, Context& context) {
  auto options = std::make_shared<FaultOptions>();
  CLI::App* all = add_command(faults, "list", "Show all faults that last", "ringctl fault list",
                              "Of each: what, where, since when, and how often it struck.");
  add_json(*all, options->json);
  all->callback([&context, options] { context.action = [&context, options] { return list(context, *options); }; });
  CLI::App* one =
      add_command(faults, "remove", "End one fault", "ringctl fault remove left_knee.1", "Returns once it is undone.");
  one->add_option("ID", options->id, "Its id, as 'list' shows it")->required();
  one->callback([&context, options] { context.action = [&context, options] { return remove(context, *options); }; });
  CLI::App* every =
      add_command(faults, "clear", "End all faults, and wait until the ring is whole", "ringctl fault clear",
                  "Heals lines, thaws nodes, ends hangs, and starts what was killed.");
  every->add_option("--timeout", options->timeout_s, "How long it may take until it is whole, 0 to 600 s; default 20s")
      ->transform(cli::seconds(0, 600));
  every->callback([&context, options] { context.action = [&context, options] { return clear(context, *options); }; });
}

}  // namespace

void add_fault(CLI::App& app, Context& context) {
  CLI::App* faults = &add_group(app, "fault", "Break the ring on purpose, and mend it",
                                "ringctl fault cut left_hip:left_knee --for 2s", kFaultHelp);
  for (const fault::Word& word : fault::kWords) add_word(*faults, context, word);
  add_keeping(*faults, context);
}

namespace {

struct AtNode {
  std::optional<live::Begun> begun;
  std::exception_ptr problem;
  std::string text;        ///< of the problem
  bool no_daemon = false;  ///< it does not answer, or does not run
};

AtNode begin_at(const live::LiveFaults& faults, const fault::Fault& fault, const live::LiveFaults::Wait& wait) {
  AtNode at;
  try {
    at.begun = faults.begin(fault, wait).front();
  } catch (const std::exception& problem) {
    at.problem = std::current_exception();
    at.text = problem.what();
    at.no_daemon = dynamic_cast<const HostPortError*>(&problem) != nullptr;
  }
  return at;
}

/// One that is alone as it is.
std::exception_ptr problem_of(const std::vector<AtNode>& failed) {
  if (failed.empty()) return nullptr;
  if (failed.size() == 1) return failed[0].problem;
  std::string text;
  for (const AtNode& at : failed) text += (text.empty() ? "" : "; ") + at.text;
  const bool no_daemons = std::all_of(failed.begin(), failed.end(), [](const AtNode& at) { return at.no_daemon; });
  return no_daemons ? std::make_exception_ptr(HostPortError(text)) : std::make_exception_ptr(NotDone(text));
}

/// Leaves out of `fault` the nodes that are dead: for one of them the virtual ring would do nothing at all.
std::vector<AtNode> take_out_dead(const live::RunningDaemons& daemons, fault::Fault& fault) {
  std::vector<AtNode> dead;
  std::vector<wire::NodeId> alive;
  for (const wire::NodeId node : fault.nodes) {
    try {
      daemons.require_runs(node);
      alive.push_back(node);
    } catch (const HostPortError& problem) {
      dead.push_back({std::nullopt, std::current_exception(), problem.what(), true});
    }
  }
  fault.nodes = alive;
  return dead;
}

/// The virtual ring does it to all of its nodes at one instant, or to none.
bool is_done_by_the_ring(const std::string& ring, const fault::Fault& fault) {
  return fault::word_of(fault.name).of == fault::Of::node &&
         live::holder_of(ring_directory(ring), fault.nodes.front()).on_virtual_ring;
}

}  // namespace

BegunFaults begin_fault(const std::string& ring, const fault::RingNodes& nodes, const fault::Fault& fault,
                        const live::LiveFaults::Wait& wait) {
  const live::LiveFaults faults(ring, nodes);
  if (is_done_by_the_ring(ring, fault) && fault.name != fault::Name::start) {
    fault::Fault of_alive = fault;
    const std::vector<AtNode> dead = take_out_dead(live::RunningDaemons(ring, nodes), of_alive);
    if (of_alive.nodes.empty()) return {{}, problem_of(dead)};
    return {faults.begin(of_alive, wait), problem_of(dead)};
  }
  if (fault.nodes.size() < 2 || is_done_by_the_ring(ring, fault)) return {faults.begin(fault, wait), nullptr};
  std::vector<AtNode> all(fault.nodes.size());
  process::in_parallel(all.size(), all.size(), [&](std::size_t i) {
    fault::Fault one = fault;
    one.nodes = {fault.nodes[i]};
    all[i] = begin_at(faults, one, wait);
  });
  BegunFaults begun;
  std::vector<AtNode> failed;
  for (AtNode& at : all) at.begun ? begun.done.push_back(std::move(*at.begun)) : failed.push_back(std::move(at));
  begun.problem = problem_of(failed);
  return begun;
}

namespace {

std::string left_of(const status::Fault& fault) {
  std::string left;
  if (fault.packets_left) left = std::to_string(*fault.packets_left) + " packets";
  if (fault.seconds_left) left += (left.empty() ? "" : ", ") + app::number(*fault.seconds_left) + " s";
  return left.empty() ? "until removed" : left;
}

}  // namespace

std::string fault_table(const std::vector<status::Fault>& faults) {
  std::vector<std::vector<std::string>> table{{"id", "fault", "since s", "struck", "left"}};
  for (const status::Fault& fault : faults)
    table.push_back({fault.id.text, fault.fault, app::number(fault.age_s),
                     fault.waits       ? "waits"
                     : fault.hits == 0 ? "-"
                                       : std::to_string(fault.hits),
                     left_of(fault)});
  return app::text_table(table);
}

}  // namespace limb_ring::ringctl
