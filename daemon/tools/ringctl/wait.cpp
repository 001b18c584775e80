#include "tools/ringctl/wait.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "config/ring_config.h"
#include "core/events.h"
#include "io/signal_wait.h"
#include "ring/launched_ring.h"
#include "tools/common/command_line.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/status_rows.h"
#include "wire/control_message.h"

namespace limb_ring::ringctl {
namespace {

struct WaitOptions {
  std::string what, state;
  double timeout_s = 10;
};

Lack lack_of(const WaitOptions& options) {
  if (!options.state.empty())
    return [options](const auto& rows) { return lack_of_state(rows, options.what, options.state); };
  if (options.what != "up")
    throw UsageError(
        "'ringctl wait up' waits for the whole ring, 'ringctl wait NODE STATE' for one node: for which "
        "state of " +
        options.what + "? " + config::join(state_words()));
  return lack_of_whole;
}

int run(const Context& context, const WaitOptions& options) {
  const std::chrono::milliseconds timeout(std::llround(options.timeout_s * 1000));
  const std::string lacking = wait_for(context.ring, timeout, lack_of(options));
  if (!lacking.empty()) throw NotDone(lacking);
  return kDone;
}

}  // namespace

void add_wait(CLI::App& app, Context& context) {
  auto options = std::make_shared<WaitOptions>();
  CLI::App* command = add_command(app, "wait", "Return when the ring is whole, or a node is in a state",
                                  "ringctl wait left_knee running --timeout 5s");
  command
      ->add_option("WHAT", options->what,
                   "up: all nodes are, and the CPUs that ringd starts run; or a node, id or name")
      ->required();
  command
      ->add_option("STATE", options->state,
                   "Of that node or its CPU, in the words of 'ringctl status': up, down, "
                   "open_chain ...; running, hung, stopped, failed ...")
      ->transform(cli::one_of(state_words()));
  command->add_option("--timeout", options->timeout_s, "Exit code 1 after that time, 0 to 3600 s; default 10s")
      ->transform(cli::seconds(0, 3600));
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

using status::NodeRow;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// A daemon that lives has answered by then, also if the wait is shorter.
constexpr milliseconds kShortestLook{500};

std::string label_of(const NodeRow& row) { return "node " + label({row.id, row.name}); }

/// Why a node will never get into the ring: it is refused. Empty if no node is.
std::string refusal_in(const Rows& rows) {
  for (const NodeRow& row : rows)
    if (!row.refusals.empty()) return "; " + row.refusals.front().text;
  return {};
}

/// Nothing if no ring runs yet.
Rows rows_of(const std::string& ring, Deadline deadline, std::string& why_none) {
  try {
    return status_rows(RingAccess::open(choose_ring(ring), {}, deadline), deadline);
  } catch (const NoRing& none) {
    why_none = none.what();
    return {};
  }
}

std::string with_clock_of(const Rows& rows, const std::string& lacking) {
  return rows.front().ring.empty() ? lacking : live::with_standing_clock(lacking, rows.front().ring);
}

}  // namespace

std::string lack_of_whole(const Rows& rows) {
  for (const NodeRow& row : rows) {
    const std::string lack = lack_of_node(row, rows.size());
    if (!lack.empty()) return label_of(row) + ": " + lack + refusal_in(rows);
  }
  return {};
}

std::string lack_of_state(const Rows& rows, const std::string& node, const std::string& state) {
  std::vector<NodeName> nodes;
  for (const NodeRow& row : rows) {
    nodes.push_back({row.id, row.name});
    if (row.name != node && std::to_string(row.id) != node) continue;
    if (row.state == state || cpu_word(row) == state) return {};
    return label_of(row) + ": it is " + row.state + ", its CPU " + cpu_word(row);
  }
  throw unknown_node(node, rows.empty() ? "" : rows[0].ring, nodes);
}

std::vector<std::string> state_words() {
  std::vector<std::string> words{"down", "frozen", "unanswered", "hung", "stopped"};  // ringctl's own
  for (unsigned i = 0; i <= static_cast<unsigned>(core::NodeState::duplicate_id); ++i)
    words.emplace_back(to_string(static_cast<core::NodeState>(i)));
  for (unsigned i = 0; i <= static_cast<unsigned>(wire::CpuState::failed); ++i)
    words.emplace_back(to_string(static_cast<wire::CpuState>(i)));
  return words;
}

std::string wait_for(const std::string& ring, milliseconds timeout, const Lack& lack) {
  const auto deadline = steady_clock::now() + timeout;
  process::SignalWait signals;
  Progress progress;
  for (;;) {
    std::string lacking;
    const auto rows = rows_of(ring, std::max(deadline, steady_clock::now() + kShortestLook), lacking);
    if (lacking.empty()) lacking = lack(rows);
    if (lacking.empty()) return lacking;
    if (steady_clock::now() >= deadline) return rows.empty() ? lacking : with_clock_of(rows, lacking);
    if (process::SignalWait::asks_to_end(signals.next(process::SignalWait::kTick))) return "interrupted; " + lacking;
    progress.tell("waiting, " + lacking);
  }
}

namespace {

std::string knows_ring_of(std::size_t size) { return "it knows a ring of " + std::to_string(size) + " nodes"; }

/// What may be the reason.
std::string warning_of(const NodeRow& row) {
  std::string all;
  for (const status::Warning& warning : row.warnings) all += (all.empty() ? "" : "; ") + warning.text;
  return all.empty() ? "" : " (" + all + ")";
}

/// Also after a stop it runs.
std::string lack_of_cpu(const NodeRow& row) {
  const std::string word = cpu_word(row), why = row.cpu.last_exit.value_or("");
  if (row.cpu.kind != "child" || word == "running" || word == "stopped") return {};
  return "its CPU is " + word + (why.empty() ? "" : " (" + why + ")");
}

/// Of one on another host: its beacons say no more.
std::string lack_elsewhere(const NodeRow& row) {
  const std::string word = cpu_word(row);
  return word == "booting" || word == "failed" ? "its CPU is " + word : "";
}

std::string not_there(const ask::ToldRow& told) { return told.why_not.empty() ? "it is frozen" : told.why_not; }

}  // namespace

std::string lack_of_node(const NodeRow& row, std::size_t nodes) {
  if (!row.unanswered.empty()) return "it has not answered: " + row.unanswered;
  if (row.state != "up") return "it is " + row.state + warning_of(row);
  if (row.elsewhere) return lack_elsewhere(row);
  const std::size_t size = row.ring_size.value_or(0);
  if (size != nodes) return knows_ring_of(size) + ", not " + std::to_string(nodes);
  if (row.fold && row.fold->second_input != "up") return "its second line in is broken";
  return lack_of_cpu(row);
}

std::string lack_in_part(const NodeRow& row, std::size_t nodes) {
  const std::string& state = row.state;
  if (state == "starting" || state == "joining" || state == "duplicate_id") return "it is " + state + warning_of(row);
  const std::size_t size = row.ring_size.value_or(0);
  if (state != "open_chain" && size < nodes)
    return knows_ring_of(size) + "; " + std::to_string(nodes) + " are on this host";
  return lack_of_cpu(row);
}

RingWatch::RingWatch(const RingPlan& plan) : plan_(plan), client_(plan.ring, plan.nodes) {}

std::optional<RingWatch::NotReady> RingWatch::first_not_ready() {
  const auto told = client_.status(std::chrono::steady_clock::now() + kAnswerTime, /*with_heard=*/false);
  refusal_.clear();
  std::optional<NotReady> first;
  for (std::size_t i = 0; i < told.size(); ++i) {
    const auto& row = told[i].said;
    if (row) ring_size_ = row->ring_size.value_or(0);
    if (row && refusal_.empty() && !row->refusals.empty()) refusal_ = "; " + row->refusals.front().text;
    const std::string lack =
        row ? (plan_.is_part() ? lack_in_part : lack_of_node)(*row, told.size()) : not_there(told[i]);
    if (!first && !lack.empty()) first = NotReady{i, "node " + label(plan_.nodes[i]) + ": " + lack};
  }
  if (first) first->lack += refusal_;
  return first;
}

}  // namespace limb_ring::ringctl
