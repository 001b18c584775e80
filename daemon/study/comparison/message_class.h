#pragma once

#include <cstddef>

#include "study/comparison/network.h"

namespace limb_ring::study {

/// What waits apart in every node: interrupt-like messages (0), then data by priority (1 to 4). (ours)
constexpr std::size_t kMessageClasses = 5;
inline std::size_t class_of(const Message& message) { return message.interrupt ? 0 : 1u + message.priority; }

}  // namespace limb_ring::study
