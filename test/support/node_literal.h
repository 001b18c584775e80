#pragma once

#include "wire/packet.h"

namespace limb_ring {

/// 3_id: node 3.
constexpr wire::NodeId operator""_id(unsigned long long id) { return wire::NodeId{static_cast<std::uint8_t>(id)}; }

}  // namespace limb_ring
