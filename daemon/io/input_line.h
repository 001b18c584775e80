#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/endpoint.h"
#include "io/input_handler.h"
#include "io/link_counters.h"
#include "io/link_header.h"
#include "io/refusals.h"
#include "io/report_once.h"

namespace limb_ring::link {

/// Where an Input listens, and whom it may let in.
struct InputSettings {
  Identity self;
  Endpoint endpoint;                ///< where we listen, for nodes of this host
  std::vector<std::uint8_t> order;  ///< ids of all nodes in ring order, ours among them
  Timing timing;
  nanoseconds delay{0};                               ///< slices are handed on so much later
  std::optional<Endpoint> from_hosts = std::nullopt;  ///< where we listen for nodes of other hosts, if elsewhere
  std::vector<std::string> names = {};                ///< of the nodes in `order`, for messages; may be empty
};

/// What an Input keeps account of, whatever its transport.
struct InputReport {
  InputCounters counters;
  std::string last_unknown_peer;  ///< why the last unknown peer was turned away; for people
  ReportOnce report_once;         ///< of such a reason, since the input came up
  Refusals refusals;
  void unknown_peer(std::string why) {
    ++counters.unknown_peers;
    last_unknown_peer = std::move(why);
  }
  /// The sender of `connect`, shown to people as `who`, was answered `refuse`: counts it, and tells the handler once,
  /// unless asking again mends it.
  void turned_away(const std::string& who, const LinkHeader& connect, const LinkHeader& refuse, InputHandler& handler);
  /// Node `from` is the upstream neighbour now: what was said of it, and of others before it, is over.
  void came_up(std::uint8_t from);
};

/// One transport's receiving end. No calls of the handler after close().
class InputLine {
 public:
  virtual ~InputLine() = default;
  virtual void close() = 0;
  /// Its socket's file is where it was made; also where it has none.
  virtual bool is_in_place() const { return true; }
  /// Makes its socket's file again, where it has one and that was removed. What is connected stays so.
  /// @throw std::runtime_error
  virtual void listen_again() {}
  /// The upstream neighbour that came in by this line; nothing if there is none, or it came in by another line.
  virtual std::optional<std::uint8_t> from() const = 0;
  /// Tells its upstream neighbour that node `by` takes its place, and loses it. @pre from()
  virtual void replace(std::uint8_t by) = 0;
};

}  // namespace limb_ring::link
