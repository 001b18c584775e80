#include "app/ringctl/ping_run.h"

#include <algorithm>

#include "app/common/text_table.h"
#include "app/ringctl/connect_node.h"
#include "app/ringctl/node_name.h"
#include "app/ringctl/progress.h"
#include "app/ringctl/result_wait.h"
#include "app/ringctl/results.h"
#include "core/time.h"

namespace limb_ring::ringctl {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// The last packet may take so long beyond the end of all: it is not to be counted as lost.
constexpr std::chrono::seconds kLastResult{1};
constexpr auto kOutcomes = {Outcome::refused,     Outcome::no_such_node, Outcome::lost,
                            Outcome::unconfirmed, Outcome::rejected,     Outcome::cancelled};

double in_seconds(std::chrono::nanoseconds time) { return std::chrono::duration<double>(time).count(); }

}  // namespace

void PingTotals::add(const Result& result) {
  const std::uint64_t before = ended_[result.outcome]++;
  if (result.outcome != Outcome::delivered) return;
  least_ = std::min(least_, result.round_trip);
  most_ = std::max(most_, result.round_trip);
  if (kept_.size() < kKept)
    kept_.push_back(result.round_trip);
  else
    kept_[before % kKept] = result.round_trip;  // the oldest one's place
}

std::uint64_t PingTotals::with(Outcome outcome) const {
  const auto found = ended_.find(outcome);
  return found == ended_.end() ? 0 : found->second;
}

std::uint64_t PingTotals::ended() const {
  std::uint64_t all = 0;
  for (const auto& [outcome, count] : ended_) all += count;
  return all;
}

statistics::Percentiles PingTotals::round_trips() const {
  std::vector<core::Duration> samples(kept_.begin(), kept_.end());
  statistics::Percentiles trips = statistics::percentiles(samples);
  if (kept_.empty()) return trips;
  trips.min = statistics::microseconds(least_);
  trips.max = statistics::microseconds(most_);
  trips.samples = with(Outcome::delivered);
  return trips;
}

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
    asked_to_end_ = process::SignalWait::asks_to_end(signals_.next(milliseconds(0)));
    wait.check();
    if (order_.deadline && steady_clock::now() - begun_ >= *order_.deadline + kLastResult)
      throw gone(port_, "no result of the last packet within " + std::to_string(kLastResult.count()) + " s");
  }
}

void PingRun::wait_for_turn(std::uint64_t number) {
  const auto turn = begun_ + order_.interval * static_cast<std::int64_t>(number);
  while (!over()) {
    const auto left = std::chrono::ceil<milliseconds>(turn - steady_clock::now());
    asked_to_end_ =
        process::SignalWait::asks_to_end(signals_.next(std::clamp(left, milliseconds(0), process::SignalWait::kTick)));
    look_for_the_end();
    if (left <= milliseconds(0)) return;
  }
}

std::string ping_line(const PingOrder& order, std::uint64_t sequence, const Result& result) {
  const std::string seq = "seq=" + std::to_string(sequence);
  const std::string who = label(order.to) + ": ";
  if (result.outcome != Outcome::delivered) return who + seq + ' ' + to_text(result);
  const double us = static_cast<double>(result.round_trip.count()) / 1000;
  return std::to_string(order.size) + " bytes to " + who + seq + " time=" + app::number(us) + " us" +
         (result.tries > 1 ? " tries=" + std::to_string(result.tries) : "");
}

std::string ping_text(const PingOrder& order, const PingTotals& totals) {
  const std::uint64_t delivered = totals.with(Outcome::delivered);
  std::string text = "--- " + order.to.name + " ping statistics ---\n" + std::to_string(totals.sent) + " sent, " +
                     std::to_string(delivered) + " delivered";
  for (const Outcome outcome : kOutcomes)
    if (const auto count = totals.with(outcome); count != 0)
      text += ", " + std::to_string(count) + ' ' + to_string(outcome);
  if (totals.sent > totals.ended()) text += ", " + std::to_string(totals.sent - totals.ended()) + " not ended";
  text += ", " + app::number(in_seconds(totals.took), 3) + " s\n";
  const auto trips = totals.round_trips();
  if (trips.samples == 0) return text;
  return text + "round trip min/p50/p99/max = " + app::number(trips.min) + '/' + app::number(trips.p50) + '/' +
         app::number(trips.p99) + '/' + app::number(trips.max) + " us" +
         (totals.all_are_kept() ? "" : "; p50 and p99 of the last " + std::to_string(PingTotals::kKept)) + '\n';
}

json ping_json(const PingOrder& order, const PingTotals& totals) {
  json other = json::object();
  for (const Outcome outcome : kOutcomes)
    if (const auto count = totals.with(outcome); outcome != Outcome::lost && count != 0)
      other[to_string(outcome)] = count;
  const double seconds = in_seconds(totals.took);
  const auto delivered = totals.with(Outcome::delivered);
  return {{"to", order.to.id},
          {"count", order.count},
          {"sent", totals.sent},
          {"delivered", delivered},
          {"lost", totals.with(Outcome::lost)},
          {"other", other},
          {"round_trip_us", statistics::to_json(totals.round_trips())},
          {"seconds", seconds},
          {"packets_per_second", seconds > 0 ? static_cast<double>(delivered) / seconds : 0.0}};
}

}  // namespace limb_ring::ringctl
