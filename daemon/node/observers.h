#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "node/host_server.h"
#include "node/node_driver.h"

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

}  // namespace limb_ring::runtime
