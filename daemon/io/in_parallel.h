#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace limb_ring::process {

/// Calls work(i) for each i below `count`, at most `most` of them at the same time; returns when all have been done.
/// If the system has no threads for so many, fewer are done at the same time. What `work` throws first is thrown at
/// the end, and what was not begun by then is not done.
template <class Work>
void in_parallel(std::size_t count, std::size_t most, Work work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::once_flag first;
  const auto do_some = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      std::call_once(first, [&] { thrown = std::current_exception(); });
      next = count;
    }
  };
  std::vector<std::thread> threads;
  const std::size_t helpers = std::min(most, count);
  threads.reserve(helpers);
  try {
    while (threads.size() + 1 < helpers) threads.emplace_back(do_some);
  } catch (const std::system_error&) {  // what they do not do, this thread does
  }
  do_some();
  for (std::thread& thread : threads) thread.join();
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace limb_ring::process
