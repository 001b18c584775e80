#pragma once

#include <exception>

#include "ring/ring_clock.h"
#include "ros_bridge/ring_port.h"

namespace limb_ring::bridge {

/// Does what a service was called for. Whatever goes wrong becomes the answer: a service that just fails gives its
/// caller no reason. @return true, as ROS wants it of a service that has answered
template <typename Response, typename Call>
bool answered(RingPort& port, Response& response, Call call) {
  const RingPort::TimeGoesOn time_goes_on(port);  // even if it is held for a controller, as calls take ring time
  try {
    response.success = true;
    call();
  } catch (const HostPortTimeout& late) {
    response.success = false;
    response.message = live::with_standing_clock(late.what(), port.ring());
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
  }
  return true;
}

}  // namespace limb_ring::bridge
