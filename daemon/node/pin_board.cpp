#include "node/pin_board.h"

namespace limb_ring::runtime {

void PinBoard::latch(std::uint8_t source, std::int64_t clock_ns) {
  latch_ = {latch_.count + 1, wire::NodeId{source}, static_cast<std::uint64_t>(clock_ns)};
  cpu_.clock_latched(latch_);
}

std::string PinBoard::pull(std::uint8_t factor, std::uint8_t source, std::int64_t clock_ns) {
  using Action = config::PinConfig::Action;
  using Interrupt = limb_ring::Interrupt;
  const config::PinConfig& pin = pins_[factor];
  const std::string by = "INT" + std::to_string(factor) + " from node " + std::to_string(source);
  switch (pin.action) {
    case Action::none:
      return by + ": wired to nothing";
    case Action::reset:
      return by + ": reset: " + cpu_.reset(by).message;
    case Action::stop:
      cpu_.interrupt(Interrupt::Action::stop, source, factor);
      return by + ": stop";
    case Action::notify:
      cpu_.interrupt(Interrupt::Action::notify, source, factor);
      return by + ": notify";
    case Action::signal:
      return by + ": signal: " + cpu_.signal(pin.signal).message;
    case Action::exec:
      return by + ": exec: " + cpu_.run(pin.command).message;
    case Action::sync:
      latch(source, clock_ns);
      return by + ": clock latched";
  }
  return by;
}

}  // namespace limb_ring::runtime
