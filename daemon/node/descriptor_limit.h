#pragma once

#include <string>

#include "config/ring_config.h"

namespace limb_ring::runtime {

/// "only 32 file descriptors may be open (ulimit -n), this node needs up to 88"; empty where that is enough. Beyond the
/// limit lines and clients are refused, for reasons that do not name it.
std::string too_few_descriptors(const config::RingConfig& ring);

}  // namespace limb_ring::runtime
