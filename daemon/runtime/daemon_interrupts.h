#pragma once

#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <list>
#include <map>

#include "runtime/cpu_sightings.h"
#include "runtime/engine.h"
#include "watchdog/reset_order.h"

namespace limb_ring::runtime {

/// Interrupts that the daemon itself sends, for its clients and for the watchdog, and the resets that wait for what
/// such an interrupt does.
class DaemonInterrupts {
 public:
  using Ended = std::function<void(const core::SendEnded&)>;
  using ResetDone = std::function<void(const watchdog::ResetReport&)>;

  DaemonInterrupts(boost::asio::io_context& io, Engine& engine, const CpuSightings& cpus)
      : io_(io), engine_(engine), cpus_(cpus) {}

  void interrupt(wire::NodeId to, std::uint8_t factor, Ended done);
  /// Pulls the reset pin of `node` and waits until it is known what has come of it.
  void reset(wire::NodeId node, std::uint8_t factor, std::chrono::milliseconds timeout, ResetDone done);

  void on_ended(const core::SendEnded& ended);
  /// Something new is known of a node's CPU.
  void on_cpu_changed(wire::NodeId node);
  void stop();

 private:
  struct Reset {
    Reset(boost::asio::io_context& io, wire::NodeId n, const watchdog::CpuKnown& before, core::Time now, ResetDone d)
        : node(n), order(before, now), done(std::move(d)), deadline(io) {}
    wire::NodeId node;
    watchdog::ResetOrder order;
    ResetDone done;
    boost::asio::steady_timer deadline;
  };
  using ResetPlace = std::list<Reset>::iterator;

  /// @param report none: it goes on
  void finish(ResetPlace place, const watchdog::ResetOrder::Report& report);
  ResetPlace place_of(const Reset* reset);

  boost::asio::io_context& io_;
  Engine& engine_;
  const CpuSightings& cpus_;
  std::uint32_t last_token_ = 0;
  std::map<std::uint32_t, Ended> interrupts_;
  std::list<Reset> resets_;
};

}  // namespace limb_ring::runtime
