#pragma once

#include "bench/report.h"
#include "bench/setup.h"
#include "ring/private_folder.h"

namespace limb_ring::bench {

/// Runs everything, or what Setup::only says. Takes about 20 times Setup::seconds. @throw std::runtime_error
Report run_suite(const Setup& setup, const live::PrivateFolder& folder);

}  // namespace limb_ring::bench
