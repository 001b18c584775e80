#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "config/ring_config.h"
#include "judge/observation_file.h"
#include "node/host_server.h"
#include "node/node_driver.h"
#include "wire/packet_assembler.h"
#include "wire/packet_filter.h"

namespace limb_ring::runtime {

/// Clients that want to see what happens at this node. Nothing is spent while there are none.
class Observers {
 public:
  Observers(host::HostServer& host, event_loop::NodeClock& clock) : host_(host), clock_(clock) {}

  /// `kinds` of ObserveFilter; empty: the client wants no events any more.
  void set(host::ClientId client, const std::set<std::string>& kinds);
  void remove(host::ClientId client) { wanted_.erase(client); }
  bool any() const { return !wanted_.empty(); }
  /// Some client wants events of that kind: only then need they be put into words.
  bool wants(const std::string& kind) const;
  /// `what` gets "kind" and "time_ns" (CLOCK_REALTIME) added.
  void tell(const std::string& kind, nlohmann::json what);
  /// Reports figures that change without an event of their own, if they have changed since the last call.
  void tell_changes(const NodeDriver& driver);

 private:
  /// What the observers were last told; all 0 again for a new one.
  struct Figures {
    unsigned ring_size = 0;
    std::uint64_t crc_errors = 0;
    std::uint64_t line_corrupted = 0;
  };

  host::HostServer& host_;
  event_loop::NodeClock& clock_;
  std::map<host::ClientId, std::set<std::string>> wanted_;
  Figures told_;
};

/// What a client wants to observe; see "Observing" in docs/reference/requests.md.
struct ObserveFilter {
  std::set<std::string> kinds;             ///< of events; empty: none
  std::optional<capture::Choice> packets;  ///< nothing: none
  bool promises = false;                   ///< all that judging the ring's promises needs
};

/// @throw std::runtime_error naming what is wrong, and what is allowed
ObserveFilter read_observe_filter(const config::RingConfig& ring, const std::string& text);

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

/// Clients that judge the ring's promises. While there are any, what enters and leaves the node's network controller
/// is written into a file, ID.watch in the ring's folder. Each client is told the path of the file and the position
/// at which to begin. A file that was removed or cut off is made again, and all are told. While there are
/// none, this costs nothing. (ours)
class PromiseObservers {
 public:
  /// @param folder the ring's
  PromiseObservers(wire::NodeId self, std::string folder, NodeDriver& driver, host::HostServer& host);
  ~PromiseObservers() { stop(); }
  PromiseObservers(const PromiseObservers&) = delete;
  PromiseObservers& operator=(const PromiseObservers&) = delete;

  /// @throw std::system_error if the file cannot be made
  void set(host::ClientId client, bool wanted);
  void remove(host::ClientId client);

  /// Its file is there, or nobody needs it.
  bool is_in_place() const;
  /// Makes the file again if it is not, and tells all. @throw std::system_error
  void put_back();

 private:
  void start();
  void stop();
  void tell(host::ClientId client);

  std::string path_;
  NodeDriver& driver_;
  host::HostServer& host_;
  std::set<host::ClientId> clients_;
  std::unique_ptr<promises::ObservationFile> file_;
  std::unique_ptr<promises::NodeObserver> observer_;
};

}  // namespace limb_ring::runtime
