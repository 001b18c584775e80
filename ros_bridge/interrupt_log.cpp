#include "ros_bridge/interrupt_log.h"

namespace limb_ring::bridge {

std::optional<std::string> InterruptLog::take(const Interrupt& interrupt, process::Throttle::Clock::time_point now) {
  const bool is_stop = interrupt.action == Interrupt::Action::stop;
  const auto held_back = (is_stop ? stops_ : notifies_).allow(now);
  if (!held_back) return std::nullopt;
  return "INT" + std::to_string(interrupt.factor) + " from node " + ring_.name_of(interrupt.source) +
         (is_stop ? ": stop" : ": notify") + process::and_more(*held_back);
}

}  // namespace limb_ring::bridge
