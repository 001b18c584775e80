#pragma once

#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <list>
#include <map>

#include "runtime/engine.h"

namespace limb_ring::runtime {

/// How a reset of another node's CPU ended.
struct ResetReport {
  bool success = false;         ///< a higher CPU boot number was heard over the ring
  std::string message;
  core::Duration round_trip{0}; ///< of the INTP
  std::uint32_t boots = 0;      ///< of that CPU, as last heard
  std::chrono::milliseconds confirmed{0};  ///< from the order to the confirmation
};

/// Interrupts that the daemon itself sends for its clients, and what has to come of them.
class Orders {
 public:
  using Ended = std::function<void(const core::SendEnded&)>;
  using ResetDone = std::function<void(const ResetReport&)>;

  /// What is known of a node's CPU: its own beacons, or for this node the CPU itself.
  struct Cpu {
    std::uint32_t boots = 0;
    bool comes_back = true;  ///< somebody starts it again when it is killed
    bool absent = false;     ///< there is none to kill
  };
  using CpuOf = std::function<Cpu(wire::NodeId)>;

  Orders(boost::asio::io_context& io, Engine& engine, CpuOf cpu_of)
      : io_(io), engine_(engine), cpu_of_(std::move(cpu_of)) {}

  void interrupt(wire::NodeId to, std::uint8_t factor, Ended done);
  /// Pulls the reset pin of `node` and waits until its beacons carry a higher CPU boot number:
  /// not for the first packet that happens to be under way. (ours, protocol.md section 5)
  void reset(wire::NodeId node, std::uint8_t factor, std::chrono::milliseconds timeout, ResetDone done);

  void on_ended(const core::SendEnded& ended);
  /// Something new is known of a node's CPU.
  void on_cpu_changed(wire::NodeId node);
  void stop();

 private:
  struct Reset {
    Reset(boost::asio::io_context& io, wire::NodeId n, ResetDone d) : node(n), done(std::move(d)), deadline(io) {}
    wire::NodeId node;
    ResetDone done;
    boost::asio::steady_timer deadline;
    Cpu before;
    bool taken = false;
    ResetReport report;
    core::Time begun{};
  };
  using ResetPlace = std::list<Reset>::iterator;

  void reset_ended(Reset* reset, const core::SendEnded& ended);
  void finish(ResetPlace place, bool success, const std::string& message);
  ResetPlace place_of(const Reset* reset);

  boost::asio::io_context& io_;
  Engine& engine_;
  CpuOf cpu_of_;
  std::uint32_t last_token_ = 0;
  std::map<std::uint32_t, Ended> interrupts_;
  std::list<Reset> resets_;
};

}  // namespace limb_ring::runtime
