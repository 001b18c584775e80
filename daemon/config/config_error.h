#pragma once

#include <stdexcept>

namespace limb_ring::config {

/// A configuration that is refused. what() reads
/// `FILE:LINE:COLUMN: entry 'timeouts.send': '12 parsec' is not a time; allowed: a time such as
/// 100ms, 1ms to 60s`; lines and columns count from 1.
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace limb_ring::config
