#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <memory>

namespace limb_ring::runtime {

/// Polls a condition from the event loop, where nothing tells that it has changed. `done` is called once, with whether
/// `condition` has become true within `patience`; at once, from within, where it is true already.
/// @param owner of what both calls use: once it is gone, neither is called
void wait_until(boost::asio::io_context& io, const std::shared_ptr<void>& owner, std::function<bool()> condition,
                std::chrono::milliseconds patience, std::function<void(bool)> done);

}  // namespace limb_ring::runtime
