#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

/// A status row of every node (as complete_rows() has them), and when they were asked.
struct StatusSample {
  Rows rows;
  double at_s = 0;                 ///< of the machine's clock; a row with `uptime_s` has a better one
  nlohmann::json clock = nullptr;  ///< ring_clock()
};

/// What happened between two samples, a row for each node, rates if both have it:
/// {"id", "name", "state", "to", "packets_per_second", "bytes_per_second", "load", "round_trip_us", "errors", "cpu",
/// "changed"}. Rates are those of the line out of the node, its bytes are counted where they come in; the load is
/// their share of the line's rate, null if the line has none. "changed" names those of state, cpu and errors that
/// are not as they were.
std::vector<nlohmann::json> top_rows(const StatusSample& before, const StatusSample& now);

struct TopStyle {
  std::size_t lines = std::string::npos;  ///< lines there are
  std::size_t width = 80;                 ///< columns there are, 80 at least; what is over goes to the names
  bool colour = false;                    ///< ... and what has changed is marked
};

/// A heading and a line for each node.
/// @param report what there is to say below, lines of text; shown if there is room
std::string top_table(const std::string& heading, const std::vector<nlohmann::json>& rows, const TopStyle& style = {},
                      const std::string& report = {});

/// Asks all nodes for their status, over connections that it keeps, and observes them on these if asked to.
class StatusPoll {
 public:
  /// What the node at that place of the ring is to be observed by (HostPort::observe()). Called by several threads.
  using Order = std::function<std::string(std::size_t node)>;
  /// What came from that node and is not a status row.
  using Seen = std::function<void(std::size_t node, const Message& message)>;

  explicit StatusPoll(const RingAccess& ring, Order order = {}, Seen seen = {});

  /// The rows of all nodes, now; daemons that do not answer delay it by 500 ms, or 10 ms a node if that is more.
  StatusSample sample();
  /// Hands over what is observed until then.
  void listen(std::chrono::steady_clock::time_point until);
  bool is_connected(std::size_t node) { return client_.port(node) != nullptr; }
  /// Gives a node that is connected its order again.
  void observe(std::size_t node);

 private:
  std::vector<ask::ToldRow> round(bool with_heard);
  void drain(std::size_t index);

  const RingAccess& ring_;
  Order order_;
  ask::RingClient client_;
  bool wants_heard_ = false;  ///< a node did not answer: what the others have heard of it tells its state
};

}  // namespace limb_ring::ringctl
