// Who asked for a send is read back from the number that the core carries.
#include "node/session.h"

#include <gtest/gtest.h>

namespace limb_ring::runtime {
namespace {

using Kind = SendOwner::Kind;

TEST(SendOwner, OfAClientIsReadBack) {
  for (const host::ClientId client : {1u, 2u, 4'000'000'000u}) {
    const SendOwner owner = SendOwner::from_core(SendOwner::of(client).to_core());
    EXPECT_EQ(owner.kind, Kind::client);
    EXPECT_EQ(owner.client, client);
  }
}

TEST(SendOwner, OfThePartsOfTheDaemonIsReadBack) {
  for (const Kind kind : {Kind::traffic, Kind::daemon_interrupts, Kind::babbling_cpu})
    EXPECT_EQ(SendOwner::from_core(SendOwner::of(kind).to_core()).kind, kind);
}

// Its own sends end inside it: their number is nobody's here.
TEST(SendOwner, IsNeverTheControllerItself) {
  EXPECT_NE(SendOwner::of(host::ClientId{1}).to_core(), core::kController);
  for (const Kind kind : {Kind::traffic, Kind::daemon_interrupts, Kind::babbling_cpu})
    EXPECT_NE(SendOwner::of(kind).to_core(), core::kController);
}

}  // namespace
}  // namespace limb_ring::runtime
