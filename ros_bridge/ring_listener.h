#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/host_port.h"

namespace limb_ring::bridge {

/// All nodes of a ring that may be observed, in ring order.
std::vector<const config::NodeConfig*> all_nodes(const config::RingConfig& ring);

/// Observes daemons on this host, as any tool may, in a thread of its own until it is destroyed. A daemon that is gone,
/// frozen, or not started yet is tried ten times a second, and less often if it accepts and does not answer. A daemon
/// on another host is never found.
class RingListener {
 public:
  /// What came from a node, including Disconnected; called from the listening thread.
  using OnMessage = std::function<void(const config::NodeConfig& node, const Message& message)>;
  /// Whether a daemon is to tell its status row again; called from the listening thread.
  using AsksAgain = std::function<bool(const config::NodeConfig& node)>;

  /// `order`: as HostPort::observe() takes it. `daemon`: how to reach one; node and role are ignored.
  /// @param asks_again if given, each daemon is asked for its status row when it is connected, and twice a second as
  /// long as this returns true. The row comes as a Reply, in order with what is observed.
  RingListener(const std::vector<const config::NodeConfig*>& nodes, ConnectOptions daemon, std::string order,
               OnMessage on_message, AsksAgain asks_again = nullptr);
  RingListener(const RingListener&) = delete;
  RingListener& operator=(const RingListener&) = delete;
  /// Nothing is called any more after it.
  ~RingListener();
  /// Whether what happens at the node with this id comes here, as of now. From any thread.
  bool hears(std::uint8_t node) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Source {
    explicit Source(const config::NodeConfig* of) : node(of) {}
    const config::NodeConfig* node;
    std::optional<HostPort> port;
    std::atomic<bool> is_open{false};  // for other threads, which may not look at `port`
    Clock::time_point next_try{};
    bool asked = false;  ///< for its row, which has not yet come
    Clock::time_point next_ask{};
  };
  void run();
  void connect(Source& source);
  void try_to_connect(Source& source);
  void ask(Source& source);
  void wait() const;
  /// @return true if there may be more
  bool drain(Source& source);

  std::deque<Source> sources_;
  ConnectOptions daemon_;
  std::string order_;
  OnMessage on_message_;
  AsksAgain asks_again_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace limb_ring::bridge
