#pragma once

#include <chrono>

namespace limb_ring::bench {

constexpr std::chrono::milliseconds kTick{5};           ///< how often another process is polled for its end
constexpr std::chrono::milliseconds kSlice{50};         ///< how long a client waits for one message
constexpr std::chrono::milliseconds kPatience{10'000};  ///< how much longer than asked for something may take

}  // namespace limb_ring::bench
