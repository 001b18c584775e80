#include "tools/ringctl/results.h"

#include <algorithm>
#include <iostream>
#include <map>

#include "io/signal_wait.h"
#include "ring/arrived.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/connect_node.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/progress.h"
#include "tools/ringctl/refusal_counters.h"
#include "tools/ringctl/result_wait.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/tell_user.h"

namespace limb_ring::ringctl {

using std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds kRowTime{300};  // a destination that is busy is not waited for
constexpr unsigned kOutstanding = 16;               // well below a node's send queue

double microseconds_of(const Result& result) { return static_cast<double>(result.round_trip.count()) / 1000.0; }

bool delivered(const Result& result) { return result.outcome == Outcome::delivered; }

/// It was delivered, or may have been: nothing has come home that says otherwise.
bool may_be(const Result& result) { return ask::may_have_arrived(result) || result.outcome == Outcome::lost; }

}  // namespace

namespace {

/// @return false where nothing came
bool take_one(HostPort& port, std::vector<Result>& results, std::chrono::nanoseconds until_next) {
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(until_next);
  const auto message = port.receive(std::clamp(wait, std::chrono::milliseconds(0), process::SignalWait::kTick));
  if (!message) return false;
  if (const auto* result = std::get_if<Result>(&*message)) results.push_back(*result);
  if (const auto* end = std::get_if<Disconnected>(&*message)) throw gone(port, end->reason);
  return true;
}

}  // namespace

namespace {

/// Adds to `sends`, so that what has ended is kept where this throws. @throw HostPortError
void send_into(Sends& sends, HostPort& port, unsigned count, const std::function<std::uint32_t()>& send,
               std::chrono::nanoseconds interval) {
  const auto begun = steady_clock::now();
  process::Standstill standstill(begun);
  ResultWait wait(port);
  process::SignalWait signals;
  Progress progress(port.ring());
  std::vector<Result>& results = sends.results;
  while (results.size() < count) {
    tell_standstill(standstill.look(steady_clock::now()));
    const auto turn = [&] { return begun + standstill.total() + interval * static_cast<std::int64_t>(sends.sent); };
    const auto& sent = sends.sent;
    for (; sent < count && sent - results.size() < kOutstanding && turn() <= steady_clock::now(); ++sends.sent) send();
    const bool waits_for_turn = sent < count && turn() > steady_clock::now();
    if (take_one(port, results, waits_for_turn ? turn() - steady_clock::now() : process::SignalWait::kTick) ||
        sent == results.size())
      wait.restart();
    if (process::SignalWait::asks_to_end(signals.next(std::chrono::milliseconds(0)))) break;
    wait.check();
    progress.tell(std::to_string(results.size()) + " of " + std::to_string(count) + " ended");
  }
}

}  // namespace

Sends send_all(HostPort& port, unsigned count, const std::function<std::uint32_t()>& send,
               std::chrono::nanoseconds interval) {
  Sends sends;
  sends.asked = count;
  try {
    send_into(sends, port, count, send, interval);
  } catch (const HostPortError& error) {
    sends.problem = error.what();
  }
  return sends;
}

Sends send_and_explain(HostPort& port, const RingAccess& ring, std::uint8_t to, unsigned count,
                       const std::function<std::uint32_t()>& send, std::chrono::nanoseconds interval) {
  std::vector<ask::Node> nodes;
  for (const ask::Node& node : ring.ask_nodes())
    if (to == kBroadcast || node.id == to) nodes.push_back(node);
  const RefusalCounters counters(ask::status_rows(ring.ring(), nodes, kRowTime));
  Sends sends = send_all(port, count, send, interval);
  std::vector<Result>& results = sends.results;
  const auto refused = [](const Result& result) { return result.outcome == Outcome::refused; };
  if (std::any_of(results.begin(), results.end(), refused))
    counters.explain(results, nodes, ask::status_rows(ring.ring(), nodes, kRowTime));
  return sends;
}

nlohmann::json to_json(const Result& result) {
  return {{"outcome", to_string(result.outcome)},
          {"round_trip_us", microseconds_of(result)},
          {"tries", result.tries},
          {"reason", result.reason},
          {"reason_code", to_string(result.why)}};
}

namespace {

/// The round trip is that of the last try; all of them took longer.
std::string after_text(double round_trip_us, unsigned tries, const char* word_of_one) {
  const std::string took = round_trip_us > 0 ? app::number(round_trip_us) + " us" : "";
  if (tries <= 1) return took.empty() ? "" : word_of_one + took;
  return " after " + std::to_string(tries) + " tries" + (took.empty() ? "" : ", the last took " + took);
}

}  // namespace

std::string ended_text(const std::string& outcome, double round_trip_us, unsigned tries, const std::string& reason) {
  return "ended '" + outcome + '\'' + after_text(round_trip_us, tries, " after ") +
         (reason.empty() ? "" : ": " + reason);
}

std::string ended_text(const Result& result) {
  return ended_text(to_string(result.outcome), microseconds_of(result), result.tries, result.reason);
}

std::string to_text(const Result& result) {
  std::string text = to_string(result.outcome);
  text += after_text(microseconds_of(result), result.tries, " in ");
  if (!result.reason.empty()) text += ": " + result.reason;
  return text;
}

namespace {

void print_json(const Sends& sends, std::size_t good) {
  nlohmann::json list = nlohmann::json::array();
  for (const Result& result : sends.results) list.push_back(to_json(result));
  const nlohmann::json all{{"asked", sends.asked}, {"sent", sends.sent}, {"delivered", good}, {"results", list}};
  std::cout << all.dump(2) << '\n';
}

void print_text(const Sends& sends) {
  const std::vector<Result>& results = sends.results;
  if (sends.asked == 1 && results.size() == 1) {
    std::cout << to_text(results.front()) << '\n';
    return;
  }
  std::map<std::string, unsigned> ends;
  for (const Result& result : results)
    ++ends[to_string(result.outcome) + (result.reason.empty() ? "" : ": " + result.reason)];
  for (const auto& [end, count] : ends) std::cout << count << ' ' << end << '\n';
  if (sends.sent > results.size()) std::cout << sends.sent - results.size() << " not ended\n";
  if (sends.asked == sends.sent) return;
  std::cout << (sends.problem.empty() ? "interrupted, " : "") << sends.asked - sends.sent << " not sent\n";
}

}  // namespace

int exit_code(const std::vector<Result>& results) {
  if (std::all_of(results.begin(), results.end(), delivered)) return kDone;
  return std::all_of(results.begin(), results.end(), may_be) ? kUnknown : kNotDone;
}

int report(const Sends& sends, bool as_json) {
  const std::vector<Result>& results = sends.results;
  const auto good = static_cast<std::size_t>(std::count_if(results.begin(), results.end(), delivered));
  if (as_json)
    print_json(sends, good);
  else
    print_text(sends);
  if (!sends.problem.empty()) throw HostPortError(sends.problem);
  return sends.asked == results.size() ? exit_code(results) : kNotDone;
}

}  // namespace limb_ring::ringctl
