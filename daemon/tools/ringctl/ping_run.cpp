#include "tools/ringctl/ping_run.h"

#include <algorithm>
#include <string>
#include <vector>

#include "tools/ringctl/connect_node.h"
#include "tools/ringctl/progress.h"
#include "tools/ringctl/result_wait.h"
#include "tools/ringctl/tell_user.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// The last packet may take so long beyond the end of all: it is not to be counted as lost.
constexpr std::chrono::seconds kLastResult{1};

}  // namespace

PingTotals PingRun::run() {
  begun_ = steady_clock::now();
  while (!over()) {
    wait_for_turn(totals_.sent);
    if (!over()) send_one();
  }
  totals_.took = steady_clock::now() - begun_;
  return std::move(totals_);
}

bool PingRun::over() const {
  if (asked_to_end_ || !totals_.problem.empty() || (order_.count != 0 && totals_.sent >= order_.count)) return true;
  return order_.deadline && steady_clock::now() - begun_ >= *order_.deadline;
}

/// A send to a daemon that has gone would be counted as one.
void PingRun::look_for_the_end() {
  while (const auto message = port_.receive(milliseconds(0)))
    if (const auto* end = std::get_if<Disconnected>(&*message)) totals_.problem = gone(port_, end->reason).what();
}

void PingRun::send_one() {
  std::vector<std::uint8_t> data(order_.size);
  for (unsigned i = 0; i < order_.size; ++i)  // no two alike, as far as they are large enough
    data[i] = static_cast<std::uint8_t>(i < 8 ? totals_.sent >> (8 * i) : i);
  try {
    const std::uint32_t token = port_.send(order_.to.id, data, order_.priority);
    ++totals_.sent;
    wait_for_result(token);
  } catch (const HostPortError& error) {
    totals_.problem = error.what();
  }
}

void PingRun::wait_for_result(std::uint32_t token) {
  Progress progress(port_.ring());
  const ResultWait wait(port_);
  while (!asked_to_end_) {
    progress.tell();
    const auto message = port_.receive(process::SignalWait::kTick);
    if (message) {
      if (const auto* result = std::get_if<Result>(&*message); result != nullptr && result->token == token) {
        totals_.add(*result);
        return each_(totals_.sent, *result);
      }
      if (const auto* end = std::get_if<Disconnected>(&*message)) throw gone(port_, end->reason);
    }
    asked_to_end_ = asked_to_end(milliseconds(0));
    wait.check();
    if (order_.deadline && steady_clock::now() - begun_ >= *order_.deadline + kLastResult)
      throw gone(port_, "no result of the last packet within " + std::to_string(kLastResult.count()) + " s");
  }
}

void PingRun::wait_for_turn(std::uint64_t number) {
  while (!over()) {
    const auto turn = begun_ + standstill_.total() + order_.interval * static_cast<std::int64_t>(number);
    const auto left = std::chrono::ceil<milliseconds>(turn - steady_clock::now());
    asked_to_end_ = asked_to_end(std::clamp(left, milliseconds(0), process::SignalWait::kTick));
    look_for_the_end();
    if (left <= milliseconds(0)) return;
  }
}

bool PingRun::asked_to_end(milliseconds patience) {
  const bool asked = process::SignalWait::asks_to_end(signals_.next(patience));
  tell_standstill(standstill_.look(steady_clock::now()));
  return asked;
}

}  // namespace limb_ring::ringctl
