#pragma once

#include "app/ringctl/command/context.h"

namespace limb_ring::ringctl {

// One subcommand each, in a file of its name.
void add_up(CLI::App& app, Context& context);
void add_down(CLI::App& app, Context& context);
void add_status(CLI::App& app, Context& context);
void add_wait(CLI::App& app, Context& context);
void add_send(CLI::App& app, Context& context);
void add_interrupt(CLI::App& app, Context& context);
void add_pull(CLI::App& app, Context& context);
void add_sync(CLI::App& app, Context& context);
void add_stop(CLI::App& app, Context& context);
void add_resume(CLI::App& app, Context& context);
void add_reset(CLI::App& app, Context& context);
void add_ping(CLI::App& app, Context& context);
void add_observe(CLI::App& app, Context& context);
void add_dump(CLI::App& app, Context& context);
void add_trace(CLI::App& app, Context& context);
void add_replay(CLI::App& app, Context& context);
void add_top(CLI::App& app, Context& context);
void add_bench(CLI::App& app, Context& context);
void add_fault(CLI::App& app, Context& context);
void add_scenario(CLI::App& app, Context& context);
void add_scenario_list(CLI::App& scenario, Context& context);  ///< below `scenario`

}  // namespace limb_ring::ringctl
