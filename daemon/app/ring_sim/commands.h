#pragma once

#include "app/ring_sim/context.h"

namespace limb_ring::ring_sim {

// One subcommand each, in a file of its name.
void add_table(CLI::App& app, Context& context);
void add_run(CLI::App& app, Context& context);
void add_soak(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);

void add_plan(CLI::App& app, Context& context);

}  // namespace limb_ring::ring_sim
