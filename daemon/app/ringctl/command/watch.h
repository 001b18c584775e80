#pragma once

#include "app/ringctl/command/commands.h"

namespace limb_ring::ringctl {

void add_watch(CLI::App& app, Context& context);

}  // namespace limb_ring::ringctl
