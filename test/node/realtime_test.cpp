#include "node/realtime.h"

#include <gmock/gmock.h>

namespace limb_ring::runtime {
namespace {

using testing::ElementsAre;

std::vector<unsigned> cores_of(std::size_t nodes, const std::vector<unsigned>& allowed) {
  std::vector<unsigned> cores;
  for (std::size_t place = 0; place < nodes; ++place) cores.push_back(core_of(place, nodes, allowed));
  return cores;
}

TEST(Cores, NeighboursShareOne) {
  EXPECT_THAT(cores_of(6, {2, 5}), ElementsAre(2, 2, 2, 5, 5, 5));
  EXPECT_THAT(cores_of(5, {0, 1}), ElementsAre(0, 0, 0, 1, 1));
  EXPECT_THAT(cores_of(4, {3}), ElementsAre(3, 3, 3, 3));
}

TEST(Cores, EachHasItsOwnIfThereAreEnough) {
  EXPECT_THAT(cores_of(2, {0, 1}), ElementsAre(0, 1));
  EXPECT_THAT(cores_of(2, {0, 1, 2, 3}), ElementsAre(0, 2));
}

}  // namespace
}  // namespace limb_ring::runtime
