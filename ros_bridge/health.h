#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <limb_ring/NodeStatus.h>
#include <limb_ring/RingStatus.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "ring/ring_client.h"

namespace limb_ring::bridge {

/// Value of a counter of a node's daemon; 0 if it has none of that name.
std::uint64_t counter_of(const NodeStatus& node, const std::string& name);

/// By how much the error counters of a node, or of a line at it, have grown from one status to the next. A daemon that
/// was restarted (another pid) counts from 0.
class CounterGrowth {
 public:
  explicit CounterGrowth(ask::ErrorCounter::Of of);

  struct Step {
    std::string name;
    std::uint64_t by, now;
  };
  /// Those that have grown since the last call; none at the first.
  std::vector<Step> take(const NodeStatus& node);
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::map<std::string, std::uint64_t> last_;
  std::int32_t pid_ = 0;
};

/// Recent problems, each reported for a while: a diagnostics reader that reads once a second would otherwise miss what
/// came and went between two readings.
class Recent {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Recent(Clock::duration hold) : hold_(hold) {}

  /// The newest text of a key replaces the one before.
  void note(const std::string& key, const std::string& text, Clock::time_point now) { notes_[key] = {text, now}; }

  /// Calls visit(text) for each that is not older than the hold; forgets the others.
  template <class Visit>
  void each(Clock::time_point now, Visit visit) {
    for (auto note = notes_.begin(); note != notes_.end();) {
      if (now - note->second.at > hold_) {
        note = notes_.erase(note);
      } else {
        visit(note->second.text);
        ++note;
      }
    }
  }

 private:
  struct Note {
    std::string text;
    Clock::time_point at;
  };
  Clock::duration hold_;
  std::map<std::string, Note> notes_;
};

/// The condition of the line from one node to the next. (ours)
///   STALE  neither end is known (on another host, or not running), nor a break there
///   ERROR  broken, as one of its ends or the node behind the break says
///   WARN   bypassed: one of its ends leads elsewhere; or something was wrong within kWarnFor
class LineHealth {
 public:
  using Clock = std::chrono::steady_clock;

  LineHealth(const config::NodeConfig& from, const config::NodeConfig& to);

  std::string name() const { return "line " + from_.name + " -> " + to_.name; }
  void take(const RingStatus& ring, Clock::time_point now);
  void tell(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now);

 private:
  struct Finding {
    unsigned char level;
    std::string text;
  };
  Finding finding() const;
  void note_growth(CounterGrowth& counters, const NodeStatus& node, Clock::time_point now);

  const config::NodeConfig& from_;
  const config::NodeConfig& to_;
  NodeStatus before_, behind_;  // the nodes at its ends
  bool said_broken_ = false;
  CounterGrowth out_counters_, in_counters_;
  Recent recent_;
};

/// What the lines carry, from one status to the next. A line is named by the node at its end, which
/// counts what came in.
class LineLoad {
 public:
  void take(const RingStatus& ring);

  /// 0 (idle) to 1: share of the line's data rate; if it has no data rate, share of the busiest line's load. Nothing
  /// if it is unknown.
  std::optional<double> of(std::uint8_t end) const;

 private:
  struct Count {
    std::uint64_t bytes = 0;
    std::int32_t pid = 0;
    ros::Time at;
  };
  std::map<std::uint8_t, Count> counts_;
  std::map<std::uint8_t, double> bytes_per_second_, rates_;
  double busiest_ = 0;
};

/// How long a warning of an event lasts.
constexpr std::chrono::seconds kWarnFor{5};

/// The condition of one node, for diagnostics. (ours)
///   STALE  nobody has heard of it, or there is nobody to ask
///   ERROR  it was heard and is not any more; alone; its id is a duplicate; its CPU has failed or is silent
///   WARN   it is up with something wrong, or something was wrong within kWarnFor
class NodeHealth {
 public:
  using Clock = std::chrono::steady_clock;

  NodeHealth(const config::NodeConfig& node, std::chrono::milliseconds beacon);

  /// To be given every status, in order.
  void take(const RingStatus& ring, Clock::time_point now);
  /// As of the status taken last.
  void tell(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now);

 private:
  bool is_heard() const;
  void note_changes(const NodeStatus& now, Clock::time_point at);
  void tell_node(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now) const;
  void tell_cpu(diagnostic_updater::DiagnosticStatusWrapper& out) const;
  void tell_values(diagnostic_updater::DiagnosticStatusWrapper& out) const;

  const config::NodeConfig& config_;
  double longest_silence_;  // s, of its beacons
  Recent recent_{kWarnFor};
  CounterGrowth errors_;
  NodeStatus status_;
  std::int32_t last_pid_ = 0;  // while it is down it has none
  std::vector<std::string> silent_sensors_;
  bool bridge_connected_ = false, has_silent_joints_ = false, was_heard_ = false;
  Clock::time_point heard_at_{};
};

/// The condition of the whole ring, in the words of `ringctl status`. (ours)
///   ERROR  the bridge has no connection to its daemon
///   WARN   not every node is up: an open chain, folded, or some are down; or a stop is latched
void tell_ring(const RingStatus& ring, diagnostic_updater::DiagnosticStatusWrapper& out);

/// The same for people, with the CPUs that are silent or have failed; empty if nothing is wrong.
std::string what_is_wrong(const std::vector<NodeStatus>& nodes);

}  // namespace limb_ring::bridge
