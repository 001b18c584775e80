#include "ring/reset_node.h"

#include <algorithm>
#include <thread>

#include "limb_ring/host_port.h"
#include "ring/observed_daemon.h"
#include "ring/ring_client.h"

namespace limb_ring::ask {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kResetPollPeriod{50};
constexpr milliseconds kMargin{2000};  ///< for the answer, beside the time that the reset is given

const status::BrokenLine* broken_line(const Rows& rows) {
  for (const auto& [id, row] : rows)
    if (row.broken_line) return &*row.broken_line;
  return nullptr;
}

json ask_daemon(const ResetQuery& query) {
  HostPort port = live::connect_node(query.ring, std::to_string(query.from));
  const json request{{"do", "reset"}, {"node", query.target}, {"timeout_ms", query.timeout.count()}};
  return live::ask_for_people(port, request, query.timeout + kMargin);
}

// Round a fold nobody reaches all: with two breaks there are two parts.
std::string where_to_ask(const ResetQuery& query, const Rows& rows) {
  const status::BrokenLine* line = broken_line(rows);
  if (line == nullptr) return "";
  const auto is_folded = [](const auto& row) { return row.second.state == "folded"; };
  if (std::any_of(rows.begin(), rows.end(), is_folded))
    return "; the ring has folded: if it is in two parts, a node of the target's part has to ask (--from)";
  const std::string behind = name_of(query.nodes, line->behind);
  if (line->behind == query.target)
    return "; nothing reaches the first node of an open chain: " + way_to_first_of_chain(behind);
  return "; " + behind + " reaches all others, " + name_of(query.nodes, line->before) + " hears all others";
}

}  // namespace

std::optional<std::uint32_t> boots_in(const status::NodeRow& row, std::uint8_t target) {
  if (row.id == target) return row.cpu.boots.value_or(0);
  const status::Heard* peer = lately_heard_in(row, target);
  return peer == nullptr ? std::nullopt : std::optional(peer->beacon.cpu_boots);
}

bool has_no_cpu(const Rows& rows, std::uint8_t target) {
  const auto row = rows.find(target);
  if (row != rows.end()) return row->second.cpu.state == "none";
  const status::Heard* heard = lately_heard(rows, target);
  return heard != nullptr && heard->beacon.cpu_state == wire::CpuState::none;
}

std::uint8_t best_sender(const Rows& rows, const ResetQuery& query) {
  const status::BrokenLine* line = broken_line(rows);
  if (!query.from_is_free || line == nullptr) return query.from;
  const auto row = rows.find(line->behind);
  const bool chain = row != rows.end() && row->second.state == "open_chain";
  return chain && line->behind != query.target ? line->behind : query.from;
}

json judged(json answer, const ResetQuery& query, const Rows& before, const Rows& now) {
  for (const auto& [id, row] : now) {
    const auto then = before.count(id) != 0 ? boots_in(before.at(id), query.target) : std::nullopt;
    const auto boots = boots_in(row, query.target);
    if (!then || !boots || *boots <= *then) continue;
    const std::string who = id == query.target ? "its own daemon" : "its beacon at " + name_of(query.nodes, id);
    answer["success"] = true;
    answer["effect"] = "seen";
    answer["boots"] = *boots;
    answer["seen_by"] = id;
    answer["message"] = "done, seen by " + who + ": the CPU has booted again";
    return answer;
  }
  answer["message"] = answer.value("message", "") + where_to_ask(query, now);
  return answer;
}

json reset_node(ResetQuery query) {
  const Rows before = status_rows(query.ring, query.nodes, kRowTimeout);
  if (has_no_cpu(before, query.target))
    throw live::NotDone(name_of(query.nodes, query.target) + " has no CPU to reset");
  query.from = best_sender(before, query);
  const auto deadline = steady_clock::now() + query.timeout;
  const json answer = ask_daemon(query);
  if (answer.value("success", false)) return answer;
  for (;;) {
    const json known = judged(answer, query, before, status_rows(query.ring, query.nodes, kRowTimeout));
    const bool over = known.value("effect", "") != "unknown" || steady_clock::now() >= deadline;
    if (over) return known;
    std::this_thread::sleep_for(kResetPollPeriod);
  }
}

namespace {

milliseconds until(steady_clock::time_point deadline) {
  return std::chrono::duration_cast<milliseconds>(deadline - steady_clock::now());
}

}  // namespace

std::optional<std::uint8_t> next_sender(const SentStop& stop, const std::set<std::uint8_t>& senders) {
  const std::vector<KnownStop> stops = wait_until_reached(stop);
  if (stop.of_all) {
    const auto next = next_to_ask(stops, senders);
    return next ? std::optional(next->id) : std::nullopt;
  }
  if (!any_is(stops, StopState::not_reached)) return std::nullopt;
  const auto next = who_reaches(status_rows_here(stop.ring, kRowTimeout), stops[0].node.id);
  return next && senders.count(*next) == 0 ? next : std::nullopt;
}

void send_on(SentStop& stop, std::uint8_t from, steady_clock::time_point deadline, const SendStop& send,
             const NextSender& next) {
  std::set<std::uint8_t> senders{from};
  while (const auto sender = next(stop, senders)) {
    const milliseconds left = until(deadline);
    if (left <= milliseconds(0)) return;
    senders.insert(*sender);
    try {
      const bool delivered = send(*sender, left);
      stop.delivered = delivered && (!stop.of_all || stop.delivered);
    } catch (const std::exception&) {  // it has gone meanwhile: of its node nothing is known then
    }
  }
}

}  // namespace limb_ring::ask
