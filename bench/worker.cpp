#include "bench/worker.h"

#include <exception>
#include <iostream>
#include <stdexcept>
#include <thread>

#include "bench/waits.h"

namespace limb_ring::bench {
namespace {

/// @return exit code
int run(const std::function<void()>& work) {
  try {
    work();
    return 0;
  } catch (const std::exception& problem) {
    std::cerr << "benchmark: " << problem.what() << std::endl;
    return 1;
  }
}

}  // namespace

Worker::Worker(const std::function<void()>& work)
    : child_(std::make_unique<process::Child>(process::spawn_copy([&] { return run(work); }), "worker")) {
  if (child_->ended()) throw std::runtime_error(child_->ended()->text);
}

Worker::~Worker() {
  if (child_) child_->kill();
}

bool Worker::running() {
  child_->reap();
  return !child_->ended();
}

bool Worker::sets(const std::atomic<bool>& flag, const std::function<void()>& poll,
                  std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (; !flag; std::this_thread::sleep_for(kTick)) {
    poll();
    if (!running() || std::chrono::steady_clock::now() > deadline) return flag;
  }
  return true;
}

}  // namespace limb_ring::bench
