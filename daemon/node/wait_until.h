#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <memory>

namespace limb_ring::runtime {

/// Polls a condition from the event loop, for conditions whose change raises no event. `done` is called once: with
/// true when `condition` becomes true, with false after `patience`. If it is true already, from inside this call.
/// @param owner of what the two functions use: once it is gone, neither is called
void wait_until(boost::asio::io_context& io, const std::shared_ptr<void>& owner, std::function<bool()> condition,
                std::chrono::milliseconds patience, std::function<void(bool)> done);

}  // namespace limb_ring::runtime
