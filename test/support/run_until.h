#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>

namespace limb_ring::test {

/// Generous: reached only if something is wrong.
constexpr std::chrono::seconds kGuard{30};

/// Runs the event loop until `condition` holds. @return false if it never did.
inline bool run_until(boost::asio::io_context& io, const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kGuard;
  while (!condition() && std::chrono::steady_clock::now() < deadline) {
    io.restart();
    io.run_one_for(std::chrono::milliseconds(1));
  }
  return condition();
}

}  // namespace limb_ring::test
