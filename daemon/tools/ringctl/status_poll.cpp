#include "tools/ringctl/status_poll.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "io/in_parallel.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// How long daemons that do not answer may delay the next picture: in all, and for each if that is more.
constexpr milliseconds kAnswerWait{500}, kAnswerWaitEach{10};
/// Messages taken from one node before the next node has its turn.
constexpr int kMessagesAtOnce = 1000;
constexpr milliseconds kTurn{50};

}  // namespace

StatusPoll::StatusPoll(const RingAccess& ring, Order order, Seen seen)
    : ring_(ring), order_(std::move(order)), seen_(std::move(seen)), ports_(ring.nodes().size()) {}

std::vector<Answer> StatusPoll::round(bool with_heard) {
  std::vector<Answer> answers(ports_.size());
  std::vector<std::optional<std::uint32_t>> tokens(ports_.size());
  const std::string request = nlohmann::json{{"do", "status"}, {"heard", with_heard}}.dump();
  process::in_parallel(ports_.size(), kAskers, [&](std::size_t i) { tokens[i] = ask(i, request, answers[i].why_not); });
  const auto deadline = steady_clock::now() + std::max(kAnswerWait, kAnswerWaitEach * static_cast<int>(ports_.size()));
  for (std::size_t i = 0; i < ports_.size(); ++i)
    if (tokens[i]) answers[i] = answer(i, *tokens[i], deadline);
  return answers;
}

StatusSample StatusPoll::sample() {
  StatusSample sample;
  sample.at_s = std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count();
  std::vector<Answer> answers = round(wants_heard_);
  const bool absent = std::any_of(answers.begin(), answers.end(), [](const Answer& one) { return !one.said; });
  if (absent && !wants_heard_) answers = round(true);
  wants_heard_ = absent;
  sample.rows = complete_rows(ring_, std::move(answers));
  sample.clock = ring_clock(ring_.ring());
  return sample;
}

void StatusPoll::observe(std::size_t node) {
  if (order_ && is_connected(node)) ports_[node]->observe(order_(node));
}

/// @return token of the answer; nothing where none is to be waited for, with the reason where it could not be asked
std::optional<std::uint32_t> StatusPoll::ask(std::size_t index, const std::string& request, std::string& why_not) {
  const NodeName& node = ring_.nodes()[index];
  if (ring_.is_elsewhere(node)) return std::nullopt;                                // its beacons are heard here
  if (live::is_frozen(ring_directory(ring_.ring()), node.id)) return std::nullopt;  // it would let us wait
  try {
    if (!ports_[index]) {
      ports_[index] = connect_within(kAnswerWait, ring_.ring(), std::to_string(node.id), Stay::for_long);
      observe(index);
    }
    return ports_[index]->request(request);
  } catch (const HostPortError& problem) {
    why_not = problem.what();  // it is asked again next time
    return std::nullopt;
  }
}

Answer StatusPoll::answer(std::size_t index, std::uint32_t token, steady_clock::time_point deadline) {
  while (is_connected(index)) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now());
    const auto message = ports_[index]->receive(std::max(left, milliseconds(0)));
    const Reply* reply = message ? std::get_if<Reply>(&*message) : nullptr;
    if (reply != nullptr && reply->token == token) {
      auto row = nlohmann::json::parse(reply->json, nullptr, /*allow_exceptions=*/false);
      if (row.is_object()) return {row, ""};
    }
    if (message && seen_) seen_(index, *message);
    const bool late = steady_clock::now() >= deadline;  // what is observed may keep coming
    if ((!message || late) && ports_[index]->connected()) return {std::nullopt, no_answer_within(kAnswerWait)};
  }
  ports_[index].reset();
  return {std::nullopt, "its daemon has closed the connection"};
}

void StatusPoll::drain(std::size_t index) {
  for (int i = 0; i < kMessagesAtOnce && is_connected(index); ++i) {
    const auto message = ports_[index]->receive(milliseconds(0));
    if (!message) return;
    if (seen_) seen_(index, *message);
  }
}

// In turns, not as each message comes: of many packets a second, each would wake this process.
void StatusPoll::listen(steady_clock::time_point until) {
  for (;;) {
    for (std::size_t i = 0; i < ports_.size(); ++i) drain(i);
    const auto now = steady_clock::now();
    if (now >= until) return;
    std::this_thread::sleep_until(std::min(until, now + kTurn));
  }
}

}  // namespace limb_ring::ringctl
