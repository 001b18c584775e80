#pragma once

#include "io/packet_loop.h"

namespace limb_ring::event_loop {

/// What a Watch and its loop share. The loop keeps it until the end of the turn in which it was stopped.
struct Watch::State {
  PacketLoop* loop = nullptr;  ///< null: stopped
  int fd = -1;
  std::uint32_t events = 0;
  Trigger trigger = Trigger::edge;
  OnReady on_ready;
  bool again = false;
};

}  // namespace limb_ring::event_loop
