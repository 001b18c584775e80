#include "tools/ringctl/status_poll.h"

#include <algorithm>
#include <thread>
#include <utility>

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
    : ring_(ring), order_(std::move(order)), client_(ring.ring(), ring.nodes(), Stay::for_long) {
  if (seen) client_.on_message = std::move(seen);
  if (order_) client_.on_connect = [this](std::size_t node, HostPort& port) { port.observe(order_(node)); };
}

std::vector<ask::ToldRow> StatusPoll::round(bool with_heard) {
  const auto patience = std::max(kAnswerWait, kAnswerWaitEach * static_cast<int>(ring_.nodes().size()));
  return client_.status(steady_clock::now() + patience, with_heard);
}

StatusSample StatusPoll::sample() {
  StatusSample sample;
  sample.at_s = std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count();
  std::vector<ask::ToldRow> told = round(wants_heard_);
  const bool absent = std::any_of(told.begin(), told.end(), [](const ask::ToldRow& one) { return !one.said; });
  if (absent && !wants_heard_) told = round(true);
  wants_heard_ = absent;
  sample.rows = complete_rows(ring_, told);
  sample.clock = ring_clock(ring_.ring());
  return sample;
}

void StatusPoll::observe(std::size_t node) {
  HostPort* port = client_.port(node);
  if (order_ && port != nullptr) port->observe(order_(node));
}

void StatusPoll::drain(std::size_t index) {
  HostPort* port = client_.port(index);
  for (int i = 0; i < kMessagesAtOnce && port != nullptr && port->connected(); ++i) {
    const auto message = port->receive(milliseconds(0));
    if (!message) return;
    client_.on_message(index, *message);
  }
}

// In turns, not as each message comes: of many packets a second, each would wake this process.
void StatusPoll::listen(steady_clock::time_point until) {
  for (;;) {
    for (std::size_t i = 0; i < ring_.nodes().size(); ++i) drain(i);
    const auto now = steady_clock::now();
    if (now >= until) return;
    std::this_thread::sleep_until(std::min(until, now + kTurn));
  }
}

}  // namespace limb_ring::ringctl
