#pragma once

#include <cstdint>
#include <vector>

#include "wire/bytes.h"

namespace limb_ring::test {

inline wire::ByteView view(const std::vector<std::uint8_t>& bytes) { return {bytes.data(), bytes.size()}; }

}  // namespace limb_ring::test
