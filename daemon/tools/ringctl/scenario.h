#pragma once

#include "sim/scenario_run.h"
#include "tools/common/text_table.h"

namespace limb_ring::ringctl {

/// A scenario's run, as `scenario run --json` shows it.
app::Row row_of(const scenario::ScenarioRun& run);

}  // namespace limb_ring::ringctl
