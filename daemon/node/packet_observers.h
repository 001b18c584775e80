#pragma once

#include <map>
#include <optional>

#include "node/host_server.h"
#include "node/node_driver.h"
#include "wire/packet_assembler.h"
#include "wire/selection.h"

namespace limb_ring::runtime {

/// Clients that want to see the packets on this node's lines. Each gets those that it chose, as far
/// as it reads; one that is slow loses, and is told. While there are none the driver has no tap.
class PacketObservers final : private LineTap {
 public:
  PacketObservers(wire::NodeId self, NodeDriver& driver, host::HostServer& host);
  ~PacketObservers() override { driver_.set_tap(nullptr); }

  /// Nothing: the client wants no packets any more. It is told its counts as it begins and ends.
  void set(host::ClientId client, const std::optional<capture::Choice>& choice);
  /// The client is gone.
  void remove(host::ClientId client);

 private:
  struct Observer {
    capture::Selection selection;
    std::chrono::nanoseconds told_at{0};  ///< its counts
  };

  void on_input(const wire::Slice& slice, wire::NodeId from, Time at) override;
  void on_output(wire::ByteView framed_slices, wire::NodeId to, Time at) override;
  void on_input_gap(Time at) override;
  void on_output_gap(Time at) override;

  void update_taps();
  void seen(const capture::PacketView& packet);
  void give(host::ClientId client, Observer& observer, const capture::PacketView& packet);

  wire::NodeId self_;
  NodeDriver& driver_;
  host::HostServer& host_;
  capture::PacketAssembler input_, output_;
  std::map<host::ClientId, Observer> observers_;
  bool watch_input_ = false, watch_output_ = false;  ///< somebody wants to see it
};

}  // namespace limb_ring::runtime
