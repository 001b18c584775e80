#pragma once

#include <gtest/gtest.h>
#include <sched.h>

namespace limb_ring::event_loop {

/// Tests of what is done on one core; the others are given back in the end.
struct OnOneCore : testing::Test {
  cpu_set_t before{};

  void SetUp() override {
    ASSERT_EQ(::sched_getaffinity(0, sizeof before, &before), 0);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(::sched_getcpu(), &one);
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
  }
  void TearDown() override { ::sched_setaffinity(0, sizeof before, &before); }
};

}  // namespace limb_ring::event_loop
