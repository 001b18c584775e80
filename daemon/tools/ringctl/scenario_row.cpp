#include "tools/ringctl/scenario_row.h"

namespace limb_ring::ringctl {

namespace {

app::Row results_of(const scenario::SendResults& send) {
  app::Row row{{"name", send.name}, {"taken", send.tally.taken}};
  for (std::size_t i = 0; i < send.tally.results.size(); ++i)
    row[to_string(static_cast<core::Outcome>(i))] = send.tally.results[i];
  row["worst_latency_ns"] = core::whole_nanoseconds(send.tally.worst).count();
  return row;
}

}  // namespace

app::Row row_of(const scenario::ScenarioRun& run) {
  app::Row row{{"file", run.path},
               {"scenario", run.name},
               {"seed", run.seed},
               {"met", !run.unmet.has_value()},
               {"clock", run.live ? "live" : "virtual"},
               {"lasted_ns", run.lasted.count()}};
  row["expected"] = run.unmet ? app::Row(run.unmet->expected) : app::Row();
  row["seen"] = run.unmet ? app::Row(run.unmet->seen) : app::Row();
  if (run.trace) {
    row["trace_hash"] = run.trace->hash;
    row["not_repeatable"] = run.trace->not_repeatable;
  }
  row["sends"] = app::Row::array();
  for (const auto& send : run.sends) row["sends"].push_back(results_of(send));
  row["log"] = app::Row::array();
  for (const auto& line : run.log) row["log"].push_back({{"at_ns", line.at.count()}, {"what", line.words}});
  return row;
}

}  // namespace limb_ring::ringctl
