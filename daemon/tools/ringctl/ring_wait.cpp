#include "tools/ringctl/ring_wait.h"

#include <algorithm>

#include "core/events.h"
#include "io/signal_wait.h"
#include "ring/ring_clock.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/progress.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_watch.h"
#include "tools/ringctl/status_rows.h"
#include "wire/control_message.h"

namespace limb_ring::ringctl {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// A daemon that lives has answered by then, also where the wait is shorter.
constexpr milliseconds kShortestLook{500};

std::string label_of(const json& row) {
  return "node " + label({row.at("id").get<std::uint8_t>(), row.at("name").get<std::string>()});
}

/// Why a node will never get into the ring: it is refused. Empty if no node is.
std::string refusal_in(const std::vector<json>& rows) {
  for (const json& row : rows)
    for (const json& refusal : row.value("refusals", json::array())) return "; " + refusal.value("text", "");
  return {};
}

/// Nothing where no ring runs yet.
std::vector<json> rows_of(const std::string& ring, Deadline deadline, std::string& why_none) {
  try {
    return status_rows(RingAccess::open(choose_ring(ring), {}, deadline), deadline);
  } catch (const NoRing& none) {
    why_none = none.what();
    return {};
  }
}

std::string with_clock_of(const std::vector<json>& rows, const std::string& lacking) {
  for (const json& row : rows)
    if (row.contains("ring")) return live::with_standing_clock(lacking, row["ring"].get<std::string>());
  return lacking;
}

}  // namespace

std::string lack_of_whole(const std::vector<json>& rows) {
  for (const json& row : rows) {
    const std::string lack = lack_of_node(row, rows.size());
    if (!lack.empty()) return label_of(row) + ": " + lack + refusal_in(rows);
  }
  return {};
}

std::string lack_of_state(const std::vector<json>& rows, const std::string& node, const std::string& state) {
  std::vector<NodeName> nodes;
  for (const json& row : rows) {
    const std::string name = row.at("name").get<std::string>();
    nodes.push_back({row.at("id").get<std::uint8_t>(), name});
    if (name != node && row.at("id").dump() != node) continue;
    if (row.value("state", "") == state || cpu_word(row) == state) return {};
    return label_of(row) + ": it is " + row.value("state", "") + ", its CPU " + cpu_word(row);
  }
  throw unknown_node(node, rows.empty() ? "" : rows[0].value("ring", ""), nodes);
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

}  // namespace limb_ring::ringctl
