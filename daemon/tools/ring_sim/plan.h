#pragma once

#include "study/plan.h"
#include "study/traffic_run.h"
#include "tools/common/text_table.h"

namespace limb_ring::ring_sim {

/// What `ring_sim plan` has found out.
struct PlanReport {
  config::RingConfig ring;  ///< every line has a rate
  bool assumed = false;     ///< ... and not all of them from the file
  std::vector<study::Stream> streams;
  study::Plan plan;
  std::vector<study::StreamRun> runs;  ///< empty: not simulated
  std::uint64_t seed = 0;
  study::Duration duration{0};

  bool kept() const;
};

/// A row for each stream, for programs. Times in us.
std::vector<app::Row> stream_rows(const PlanReport& report);
std::vector<app::Row> node_rows(const PlanReport& report);
/// The same for people: what fits into 80 columns, with one row for all beacons.
std::vector<app::Row> short_stream_rows(const PlanReport& report);
std::vector<app::Row> short_node_rows(const PlanReport& report);
/// Everything, for programs.
app::Row plan_object(const PlanReport& report);

}  // namespace limb_ring::ring_sim
