#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace limb_ring::ask {

/// Calls work(i) for each i below `count`, at most `most` of them at the same time; returns when all have been done.
/// `work` must not throw.
template <class Work>
void in_parallel(std::size_t count, std::size_t most, Work work) {
  std::atomic<std::size_t> next{0};
  const auto do_some = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < std::min(most, count); ++i) threads.emplace_back(do_some);
  for (std::thread& thread : threads) thread.join();
}

}  // namespace limb_ring::ask
