#include "tools/ring_sim/case_rows.h"

#include "core/time.h"
#include "sim/trace.h"
#include "tools/common/text_table.h"

namespace limb_ring::ring_sim {

using study::microseconds;

namespace {

constexpr double kPercent = 100;

/// A share in percent, to 6 decimals: more is but rounding of the division.
double exact_percent(double share) {
  return static_cast<double>(static_cast<std::int64_t>(share * kPercent * 1e6 + 0.5)) / 1e6;
}

}  // namespace

std::string case_words(study::Case which, const study::Medium& medium) {
  return std::string(to_string(which)) + ", " + app::counted(medium.nodes, "node") + ", " +
         app::counted(medium.payload, "byte");
}

app::Row case_row(study::Case which, const study::Medium& medium, const study::CaseResult& result) {
  app::Row row{{"case", to_string(which)},
               {"nodes", medium.nodes},
               {"payload", medium.payload},
               {"rate_bps", medium.rate},
               {"relay_delay_ns", static_cast<double>(medium.relay_delay.count()) / 1e3},
               {"formula", study::formula_words(which, medium)}};
  const bool time = !result.has_share;
  const core::Duration worst = result.measured.max();
  row["formula_us"] = time ? app::Row(microseconds(result.formula)) : app::Row();
  row["measured_us"] = time ? app::Row(microseconds(worst)) : app::Row();
  row["difference_us"] = time ? app::Row(microseconds(worst - result.formula)) : app::Row();
  row["formula_percent"] = time ? app::Row() : app::Row(exact_percent(result.formula_share));
  row["measured_percent"] = time ? app::Row() : app::Row(exact_percent(result.measured_share));
  return row;
}

app::Row run_row(study::Case which, const study::Medium& medium, const study::CaseResult& result, std::uint64_t seed) {
  app::Row row = case_row(which, medium, result);
  row["packets"] = result.measured.count();
  row["min_us"] = microseconds(result.measured.min());
  row["mean_us"] = microseconds(result.measured.mean());
  row["p99_us"] = microseconds(result.measured.quantile(0.99));
  row["max_us"] = microseconds(result.measured.max());
  row["occupancy_percent"] = exact_percent(result.occupancy);
  row["seed"] = seed;
  row["trace_hash"] = sim::hash_text(result.trace_hash);
  return row;
}

}  // namespace limb_ring::ring_sim
