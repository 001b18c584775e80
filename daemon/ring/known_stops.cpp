#include "ring/known_stops.h"

#include <algorithm>
#include <map>
#include <optional>
#include <thread>

#include "limb_ring/payload/packet_type.h"
#include "limb_ring/ring_directory.h"
#include "ring/reset_node.h"
#include "ring/ring_files.h"

namespace limb_ring::ask {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kStopsPollPeriod{20};
constexpr milliseconds kToSaySo{1000};
constexpr milliseconds kUnderWay{200};

status::Stop stop_in(const status::NodeRow& row) { return row.cpu.stop.value_or(status::Stop{}); }

/// A CPU that is not there now. ringd starts its own children again; who else comes back, nobody knows.
bool comes_back(const std::string& state, const std::string& kind) {
  return state == "booting" || state == "failed" || (state == "absent" && kind == "child");
}

StopState state_in(const status::NodeRow& row, milliseconds age) {
  const status::Stop stop = stop_in(row);
  if (stop.latched) return StopState::stopped;
  const std::string &state = row.cpu.state, &kind = row.cpu.kind;
  if (state == "none" || (state == "absent" && !comes_back(state, kind))) return StopState::no_cpu;
  if (!stop.pulled_ms || *stop.pulled_ms > age.count()) return StopState::not_reached;
  if (comes_back(state, kind)) return StopState::booting;
  if (state == "silent" || row.cpu.hung == true) return StopState::silent;
  return stop.latches ? StopState::told : StopState::never;
}

StopState state_in_beacon(const status::Heard* heard, bool delivered) {
  if (heard == nullptr) return StopState::unknown;
  if (heard->beacon.stop_latched) return StopState::stopped;
  const std::string cpu = heard->cpu_state();
  if (cpu == "absent" || cpu == "none") return StopState::no_cpu;
  if (!delivered) return StopState::unknown;
  if (comes_back(cpu, "")) return StopState::booting;
  return cpu == "silent" ? StopState::silent : StopState::told;
}

bool is_on_virtual_ring(const std::string& ring, const std::vector<Node>& nodes) {
  return !nodes.empty() && live::holder_of(ring_directory(ring), nodes.front().id).on_virtual_ring;
}

std::string names_in(const std::vector<KnownStop>& stops, StopState state) {
  std::string names;
  for (const KnownStop& stop : stops)
    if (stop.state == state) names += (names.empty() ? "" : ", ") + stop.node.name;
  return names;
}

std::string group(const std::vector<KnownStop>& stops, StopState state, const char* words) {
  const std::string names = names_in(stops, state);
  return names.empty() ? "" : std::string("; ") + words + ": " + names;
}

}  // namespace

const char* to_string(StopState state) {
  switch (state) {
    case StopState::stopped:
      return "stopped";
    case StopState::told:
      return "told";
    case StopState::silent:
      return "silent";
    case StopState::never:
      return "never";
    case StopState::booting:
      return "booting";
    case StopState::no_cpu:
      return "no_cpu";
    case StopState::not_reached:
      return "not_reached";
    case StopState::unknown:
      return "unknown";
  }
  return "";
}

std::vector<KnownStop> known_stops(const std::vector<Node>& nodes, const Rows& rows, milliseconds age, bool delivered) {
  std::vector<KnownStop> stops;
  for (const Node& node : nodes) {
    const auto row = rows.find(node.id);
    stops.push_back({node, row == rows.end() ? state_in_beacon(lately_heard(rows, node.id), delivered)
                                             : state_in(row->second, age)});
  }
  return stops;
}

bool may_say_so(const Rows& rows, const KnownStop& stop) {
  if (stop.state == StopState::unknown) return lately_heard(rows, stop.node.id) != nullptr;
  const auto row = rows.find(stop.node.id);
  const bool latches = row == rows.end() || stop_in(row->second).latches;
  return latches && (stop.state == StopState::told || stop.state == StopState::silent);
}

milliseconds age_on_virtual_ring(const Rows& rows, milliseconds age) {
  std::optional<milliseconds> last;
  for (const auto& [id, row] : rows) {
    const auto pulled_ms = stop_in(row).pulled_ms;
    if (!pulled_ms) continue;
    const milliseconds ago(*pulled_ms);
    last = std::min(last.value_or(ago), ago);
  }
  return age + last.value_or(milliseconds(0));
}

namespace {

/// Polls the states of a stop. A CPU that boots does not know of an earlier stop, however soon it runs.
class StopPoll {
 public:
  explicit StopPoll(const SentStop& stop)
      : stop_(stop), by_ring_clock_(stop.delivered && is_on_virtual_ring(stop.ring, stop.nodes)) {}

  std::vector<KnownStop> poll() {
    rows_ = status_rows_here(stop_.ring, kRowTimeout);
    auto age = std::chrono::ceil<milliseconds>(steady_clock::now() - stop_.sent);
    if (by_ring_clock_) age = age_on_virtual_ring(rows_, age);
    std::vector<KnownStop> stops = known_stops(stop_.nodes, rows_, age, stop_.delivered);
    for (KnownStop& stop : stops) {
      if (stop.state == StopState::booting || has_booted_again(stop.node.id)) booted_.insert(stop.node.id);
      const bool runs = stop.state == StopState::told || stop.state == StopState::silent;
      if (runs && booted_.count(stop.node.id) != 0) stop.state = StopState::booting;
    }
    return stops;
  }

  const Rows& rows() const { return rows_; }

 private:
  bool has_booted_again(std::uint8_t node) {
    const auto row = rows_.find(node);
    if (row == rows_.end()) return false;
    const auto boots = row->second.cpu.boots.value_or(0);
    return boots > boots_.emplace(node, boots).first->second;
  }

  const SentStop& stop_;
  bool by_ring_clock_;
  Rows rows_;
  std::map<std::uint8_t, unsigned> boots_;  ///< when they were first asked
  std::set<std::uint8_t> booted_;
};

template <class Pending>
std::vector<KnownStop> polled(const SentStop& stop, Pending pending) {
  const auto begun = steady_clock::now();
  for (StopPoll poll(stop);;) {
    const std::vector<KnownStop> stops = poll.poll();
    const auto waited = steady_clock::now() - begun;
    if (std::none_of(stops.begin(), stops.end(), [&](const KnownStop& one) { return pending(poll, one, waited); }))
      return stops;
    std::this_thread::sleep_for(kStopsPollPeriod);
  }
}

bool is_under_way(const KnownStop& stop, steady_clock::duration waited) {
  return stop.state == StopState::not_reached && waited < kUnderWay;
}

}  // namespace

std::vector<KnownStop> wait_until_reached(const SentStop& stop) {
  return polled(stop, [](const StopPoll&, const KnownStop& one, auto waited) { return is_under_way(one, waited); });
}

std::vector<KnownStop> wait_for_stops(const SentStop& stop) {
  return polled(stop, [](const StopPoll& poll, const KnownStop& one, auto waited) {
    return (may_say_so(poll.rows(), one) && waited < kToSaySo) || is_under_way(one, waited);
  });
}

std::optional<Node> next_to_ask(const std::vector<KnownStop>& stops, const std::set<std::uint8_t>& asked) {
  std::optional<Node> next;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (stops[i].state != StopState::not_reached || asked.count(stops[i].node.id) != 0) continue;
    // Behind a node that was reached begins a part of the ring that was not.
    const bool begins = stops[(i + stops.size() - 1) % stops.size()].state != StopState::not_reached;
    if (begins) return stops[i].node;
    if (!next) next = stops[i].node;
  }
  return next;
}

std::vector<KnownStop> stops_now(const std::string& ring, const std::vector<Node>& nodes) {
  return known_stops(nodes, status_rows_here(ring, kRowTimeout), milliseconds(0), /*delivered=*/true);
}

std::vector<Node> nodes_with_latched_stop(const std::string& ring, const std::vector<Node>& nodes) {
  std::vector<Node> latched;
  for (const KnownStop& stop : stops_now(ring, nodes))
    if (stop.state == StopState::stopped) latched.push_back(stop.node);
  return latched;
}

std::vector<Node> wait_for_resumes(const std::string& ring, const std::vector<Node>& nodes) {
  if (nodes.empty()) return {};
  const auto begun = steady_clock::now();
  for (;;) {
    std::vector<Node> latched = nodes_with_latched_stop(ring, nodes);
    if (latched.empty() || steady_clock::now() - begun >= kToSaySo) return latched;
    std::this_thread::sleep_for(kStopsPollPeriod);
  }
}

std::string sentence_of_latched(const Node& node) {
  return node.name + ": it is still stopped, though its node has taken the resume: the CPU read it too late, " +
         "or there was another stop";
}

bool any_is(const std::vector<KnownStop>& stops, StopState state) {
  return std::any_of(stops.begin(), stops.end(), [state](const KnownStop& stop) { return stop.state == state; });
}

bool all_told(const std::vector<KnownStop>& stops) {
  return std::all_of(stops.begin(), stops.end(), [](const KnownStop& stop) {
    return stop.state == StopState::stopped || stop.state == StopState::told || stop.state == StopState::never ||
           stop.state == StopState::no_cpu;
  });
}

std::string sentence_of(const std::vector<KnownStop>& stops) {
  const auto stopped =
      std::count_if(stops.begin(), stops.end(), [](const KnownStop& stop) { return stop.state == StopState::stopped; });
  return std::to_string(stopped) + " of " + std::to_string(stops.size()) + " stopped" +
         group(stops, StopState::told, "told, but the CPU does not say whether it has stopped") +
         group(stops, StopState::silent, "told, but the CPU is silent and may not have stopped") +
         group(stops, StopState::never, "told, and never stops") +
         group(stops, StopState::booting, "the CPU did not run, and comes up without the stop") +
         group(stops, StopState::no_cpu, "no CPU to stop") + group(stops, StopState::not_reached, "not reached") +
         group(stops, StopState::unknown, "not known, the daemon does not answer");
}

Result resume_from_nearer(const std::string& ring, std::uint8_t target, const Result& result, const SendResume& send) {
  if (result.why != Reason::out_of_reach && result.outcome != Outcome::no_such_node) return result;
  const auto sender = who_reaches(status_rows_here(ring, kRowTimeout), target);
  if (!sender) return result;
  try {
    const Result again = send(*sender);
    return may_have_arrived(again) ? again : result;
  } catch (const HostPortError&) {  // it has gone meanwhile, or the time is up
    return result;
  }
}

void look_at(const std::string& ring, const std::vector<Node>& nodes, std::vector<Resumed>& all) {
  std::vector<Node> taken;
  for (const Resumed& one : all)
    if (may_have_arrived(one.result)) taken.push_back(one.node);
  wait_for_resumes(ring, taken);
  std::map<std::uint8_t, StopState> known;
  for (const KnownStop& stop : stops_now(ring, nodes)) known[stop.node.id] = stop.state;
  for (Resumed& one : all) {
    one.is_latched = known[one.node.id] == StopState::stopped;
    one.seen = !one.is_latched && known[one.node.id] != StopState::unknown;
  }
}

bool is_among(const std::vector<Node>& nodes, std::uint8_t id) {
  return std::any_of(nodes.begin(), nodes.end(), [id](const Node& node) { return node.id == id; });
}

namespace {

constexpr std::chrono::microseconds kValidFor = std::chrono::seconds(1);
constexpr std::uint8_t kPriority = 0;

}  // namespace

payload::JointCommand resume_command(std::int64_t stamp_ns) {
  payload::JointCommand command;
  command.resume = true;
  command.stamp_ns = stamp_ns;
  command.valid_for_us = static_cast<std::uint32_t>(kValidFor.count());
  return command;
}

Result resume_cpu(HostPort& port, std::uint8_t node, std::chrono::milliseconds timeout) {
  const auto bytes = payload::encode(resume_command(port.stamp().count()));  // cannot fail: it names no joints
  return port.wait(port.send(node, *bytes, kPriority, payload::kJointChannel), timeout);
}

}  // namespace limb_ring::ask
