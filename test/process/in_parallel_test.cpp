// Work for several threads, also if the system has none to give.
#include "io/in_parallel.h"

#include <gmock/gmock.h>
#include <pthread.h>

namespace limb_ring::process {
namespace {

using ::testing::Each;

/// How often each of 100 pieces of work is done.
std::vector<int> done_by(std::size_t most) {
  std::vector<std::atomic<int>> done(100);
  in_parallel(done.size(), most, [&](std::size_t i) { ++done[i]; });
  return {done.begin(), done.end()};
}

TEST(InParallel, DoesEachOnce) {
  for (const std::size_t most : {1, 8, 200}) EXPECT_THAT(done_by(most), Each(1)) << most;
  in_parallel(0, 8, [](std::size_t) { FAIL(); });
}

TEST(InParallel, DoesItAloneIfNoThreadCanBeMade) {
  pthread_attr_t usual, too_large;
  ASSERT_EQ(pthread_getattr_default_np(&usual), 0);
  ASSERT_EQ(pthread_attr_init(&too_large), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&too_large, std::size_t{1} << 47), 0);  // no address space is so large
  ASSERT_EQ(pthread_setattr_default_np(&too_large), 0);
  EXPECT_THROW(std::thread([] {}).join(), std::system_error);
  EXPECT_THAT(done_by(8), Each(1));
  ASSERT_EQ(pthread_setattr_default_np(&usual), 0);
}

TEST(InParallel, ThrowsWhatWasThrownInAnyOfItsThreads) {
  for (const std::size_t most : {1, 8}) {
    const auto no_room = [](std::size_t i) {
      if (i >= 50) throw std::bad_alloc();
    };
    EXPECT_THROW(in_parallel(100, most, no_room), std::bad_alloc) << most;
  }
}

}  // namespace
}  // namespace limb_ring::process
