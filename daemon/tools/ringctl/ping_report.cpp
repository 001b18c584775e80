#include "tools/ringctl/ping_report.h"

#include <chrono>

#include "tools/common/text_table.h"
#include "tools/ringctl/node_name.h"
#include "tools/ringctl/results.h"

namespace limb_ring::ringctl {

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

}  // namespace limb_ring::ringctl
