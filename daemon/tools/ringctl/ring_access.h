#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "ring/launched_ring.h"
#include "ring/observed_daemon.h"
#include "ring/ring_client.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

using live::connect_node;
using live::Stay;

/// The error for a daemon that has gone while it was asked: names the node, and says why.
HostPortError gone(const HostPort& port, const std::string& reason);

using NodeName = ask::Node;

/// "12 (left_knee)"
std::string label(const NodeName& node);

/// The error for a node that the ring does not have: lists those it has, and guesses which was meant.
UsageError unknown_node(const std::string& word, const std::string& ring, const std::vector<NodeName>& nodes);

/// Until when answers are waited for; by itself until each daemon has had its time.
using Deadline = std::chrono::steady_clock::time_point;
constexpr Deadline kNoDeadline = Deadline::max();

/// A machine that runs some of the nodes.
using RingHost = status::ConfiguredHost;

/// All daemons of the ring that live are frozen.
struct AllFrozen : NoRing {
  using NoRing::NoRing;
};

/// A running ring, as one of its daemons describes it.
struct RingDescription {
  std::string ring;
  std::vector<NodeName> nodes;          ///< in ring order; at least one
  std::size_t answered = 0;             ///< place in `nodes` of the one whose daemon said all this
  std::vector<RingHost> hosts;          ///< none if the ring's file gives none
  std::string path;                     ///< of the ring's YAML file; may be empty
  bool folds_back = false;              ///< it has a second line
  std::chrono::milliseconds beacon{0};  ///< time between two beacons of a node; 0: unknown
};

/// Access to a running ring: which nodes it has, and connections to those of this host.
class RingAccess {
 public:
  /// Asks `first` (id or name; may be empty), then one daemon after the other that is not frozen, how the ring is
  /// configured; if one keeps us waiting, all at the same time. @throw NoRing if none answers, AllFrozen if
  /// none could
  static RingAccess open(const std::string& ring, const std::string& first = {}, Deadline deadline = kNoDeadline);
  /// As open(). If none answers, because nodes were killed or frozen on purpose, the nodes of this host by what
  /// their files tell, in the order of their ids.
  static RingAccess open_also_dead(const std::string& ring);
  explicit RingAccess(RingDescription ring) : ring_(std::move(ring)) {}

  const std::string& ring() const { return ring_.ring; }
  const std::string& path() const { return ring_.path; }
  bool folds_back() const { return ring_.folds_back; }
  std::chrono::milliseconds beacon() const { return ring_.beacon; }
  const std::vector<NodeName>& nodes() const { return ring_.nodes; }

  const std::vector<RingHost>& hosts() const { return ring_.hosts; }
  const std::string& here() const { return answered().host; }  ///< this host; empty if there are none
  bool is_elsewhere(const NodeName& node) const { return node.host != here(); }
  std::vector<NodeName> nodes_here() const;
  /// @throw Elsewhere if it is on another host
  void require_here(const NodeName& node) const;

  /// @throw UsageError listing the nodes there are
  const NodeName& node(const std::string& id_or_name) const;
  /// Id of a node, or kBroadcast for "all". @throw UsageError
  std::uint8_t destination(const std::string& id_or_name_or_all) const;
  /// As node(); for an empty text the node that described the ring.
  const NodeName& source(const std::string& id_or_name) const;
  /// @throw HostPortError, Elsewhere
  HostPort connect(const NodeName& node, Stay stay = Stay::asks_only) const;

 private:
  const NodeName& answered() const { return ring_.nodes[ring_.answered]; }

  RingDescription ring_;
};

/// The ring given, else the environment's LIMB_RING_RING; empty if neither names one.
/// @throw UsageError if that cannot be a ring's name
std::string named_ring(const std::string& given);

/// The ring that a command is for: the one given, else the environment's LIMB_RING_RING, else the only one
/// running, else the only one that is dead because its daemons were killed on purpose.
/// @throw NoRing if there is none; UsageError listing them if several run.
std::string choose_ring(const std::string& given);

/// The same for a command that takes the name as its argument RING, too; each may be empty.
/// @throw also UsageError if the two differ
std::string choose_ring(const std::string& argument, const std::string& option);

using live::ring_clock;
using live::standing_clock;

/// What ring_clock() says, behind a headline: "; virtual clock at 12.345 s, pace 1, 0.020 s late, 3.100 s lost"; empty
/// for null.
std::string clock_words(const nlohmann::json& clock);

/// To be called when what was asked for has not been answered in time. @throw NotKnown with standing_clock(), if it
/// stands: it may happen once it goes on
void require_clock_goes(const std::string& ring);

/// "1", "0.1", "max"
std::string pace_text(const nlohmann::json& pace);

/// How long a daemon may take for an answer that needs no waiting.
constexpr std::chrono::milliseconds kAnswerTime{2000};
/// How long it may take to answer a request that sends an interrupt: the answer comes when the interrupt has ended.
constexpr std::chrono::milliseconds kInterruptTime{10'000};

/// Asks a daemon, with progress on standard error if it takes long.
/// @throw NotDone with what the daemon says is wrong; HostPortError if it does not answer
nlohmann::json ask(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout);
/// The same, with `tick` called now and then while it waits; it may throw.
nlohmann::json ask(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout,
                   const std::function<void()>& tick);

/// Asks all of these nodes at the same time. No answer takes longer than kAnswerTime.
std::vector<ask::Answer> ask_all(const std::string& ring, const std::vector<NodeName>& nodes,
                                 const nlohmann::json& request, Deadline deadline = kNoDeadline);

/// The same of their status rows.
std::vector<ask::ToldRow> ask_for_rows(const std::string& ring, const std::vector<NodeName>& nodes,
                                       Deadline deadline = kNoDeadline);

}  // namespace limb_ring::ringctl
