#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "core/archive.h"

namespace limb_ring::core {

/// The state of anything that has one (archive.h).
template <class What>
std::vector<std::uint8_t> bytes_of(What& what) {
  std::vector<std::uint8_t> room(1 << 20);
  StateWriter writer(room.data(), room.size());
  what.archive(writer);
  EXPECT_FALSE(writer.failed());
  room.resize(writer.size());
  return room;
}

/// From now on `what` has that state.
template <class What>
void read_state(const std::vector<std::uint8_t>& bytes, What& what) {
  StateReader reader({bytes.data(), bytes.size()});
  what.archive(reader);
  EXPECT_TRUE(reader.complete());
}

}  // namespace limb_ring::core
