#include "tools/ringctl/ping.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/time.h"
#include "tools/common/command_line.h"
#include "tools/common/picture_page.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/send.h"

namespace limb_ring::ringctl {
namespace {

constexpr std::uint64_t kCountOfAReport = 10;  // of --json, which has to end
constexpr double kUnset = -1;

struct PingOptions {
  std::string from, to;
  std::uint64_t count = 0;
  unsigned size = kMaxPayload, priority = 2;
  double interval_s = kUnset, timeout_s = 0, bound_s = kUnset;
  std::string html;
  bool flood = false, quiet = false, json = false;
};

std::chrono::nanoseconds to_nanoseconds(double seconds) {
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

PingOrder order_of(const RingAccess& ring, const PingOptions& options) {
  PingOrder order;
  order.to = ring.node(options.to);
  order.count = options.count == 0 && options.json ? kCountOfAReport : options.count;
  const bool flood = options.flood || (options.json && options.interval_s == kUnset);
  order.interval = to_nanoseconds(flood ? 0 : options.interval_s == kUnset ? 1 : options.interval_s);
  if (options.timeout_s > 0) order.deadline = to_nanoseconds(options.timeout_s);
  order.size = options.size;
  order.priority = static_cast<std::uint8_t>(options.priority);
  return order;
}

void write_picture(const PingOptions& options, const std::string& from, const PingOrder& order,
                   const PingTotals& totals) {
  std::ofstream file;
  if (const std::string problem = app::open_for_writing(file, options.html); !problem.empty()) throw NotDone(problem);
  app::StreamLatencies stream{from + " to " + order.to.name, {}, {}};
  for (const std::chrono::nanoseconds one : totals.kept())
    stream.latencies.push_back(static_cast<double>(one.count()) / 1000);
  if (options.bound_s != kUnset) stream.bound = options.bound_s * 1e6;
  app::write_latencies(file, "Round trips from " + from + " to " + order.to.name,
                       "Measured live: " + std::to_string(totals.sent) + " packets of " + std::to_string(order.size) +
                           " bytes, from the first byte that leaves to the matched return." +
                           (stream.bound ? " The dashed line is --bound." : ""),
                       {stream});
  if (const std::string problem = cli::finish_writing(file, options.html); !problem.empty()) throw NotDone(problem);
}

int run(const Context& context, const PingOptions& options) {
  if (options.bound_s != kUnset && options.html.empty()) throw UsageError("--bound goes with --html");
  if (!options.html.empty())
    if (const std::string problem = app::why_not_writable(options.html); !problem.empty())
      throw UsageError("--html " + problem);
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const PingOrder order = order_of(ring, options);
  const NodeName& from = ring.source(options.from);
  HostPort port = ring.connect(from, Stay::for_long);
  const bool lines = !options.quiet && !options.json;
  if (!options.json)
    std::cout << "PING " << label(order.to) << " from " << label(from) << ": " << order.size << " bytes of data"
              << std::endl;
  const PingTotals totals = PingRun(port, order, [&](std::uint64_t sequence, const Result& result) {
                              if (lines) std::cout << ping_line(order, sequence, result) << std::endl;
                            }).run();
  if (options.json)
    std::cout << ping_json(order, totals).dump(2) << '\n';
  else
    std::cout << (lines ? "\n" : "") << ping_text(order, totals);
  if (!options.html.empty()) write_picture(options, from.name, order, totals);
  if (!totals.problem.empty()) throw HostPortError(totals.problem);
  const bool all = order.count == 0 || totals.sent == order.count;
  const std::uint64_t ended = totals.ended();
  return all && totals.with(Outcome::delivered) == ended && ended != 0 ? kDone : kNotDone;
}

void add_options(CLI::App& command, PingOptions& options) {
  command.add_option("TO,--to", options.to, "Node to send to, id or name; as `ping NODE` or `ping --to NODE`")
      ->required();
  command.add_option("--from", options.from, "Node that sends, id or name; default: the first that answers");
  command.add_option("-c,--count", options.count, "End after N packets, 1 to 1000000; default: at Ctrl-C (--json: 10)")
      ->transform(cli::whole(1, 1000000));
  CLI::Option* interval =
      command
          .add_option("-i,--interval", options.interval_s,
                      "Time between two packets, 0 to 3600 s, such as 5ms or 0.2; default 1s, with --json 0")
          ->transform(cli::seconds(0, 3600));
  command.add_flag("-f,--flood", options.flood, "Send the next as soon as one returns")->excludes(interval);
  command.add_flag("-q,--quiet", options.quiet, "Print only the statistics at the end");
  command.add_option("-s,--size", options.size, "Bytes in each packet, 1 to 512; default 512")
      ->transform(cli::whole(1, kMaxPayload));
  command.add_option("--priority", options.priority, "0 (highest) to 3; default 2")->transform(cli::whole(0, 3));
  command.add_option("--html", options.html, "At the end, write a page there: a histogram of the round trips");
  command.add_option("--bound", options.bound_s, "A line in it: what is allowed, 0.000001 to 3600 s, as 1ms")
      ->transform(cli::seconds(0.000001, 3600));
  command.add_option("-w,--timeout", options.timeout_s, "End after that time, 0.001 to 3600 s; default: never")
      ->transform(cli::seconds(0.001, 3600));
}

}  // namespace

void add_ping(CLI::App& app, Context& context) {
  auto options = std::make_shared<PingOptions>();
  CLI::App* command =
      add_command(app, "ping", "Send packets to a node, and print each round trip", "ringctl ping left_knee --count 5",
                  "Runs until Ctrl-C. The daemon takes the times, from the first byte that leaves to the matched "
                  "return.");
  add_options(*command, *options);
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

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

using nlohmann::json;

namespace {

constexpr auto kOutcomes = {Outcome::refused,     Outcome::no_such_node, Outcome::lost,
                            Outcome::unconfirmed, Outcome::rejected,     Outcome::cancelled};

double in_seconds(std::chrono::nanoseconds time) { return std::chrono::duration<double>(time).count(); }

}  // namespace

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

}  // namespace limb_ring::ringctl
