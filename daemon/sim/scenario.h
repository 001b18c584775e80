#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/fault.h"
#include "config/ring_config.h"
#include "core/events.h"
#include "core/outcome.h"
#include "core/time.h"
#include "wire/control_message.h"

/// A scenario: what is done to a ring and when, and what has to be seen. (ours)
/// Nodes are places in ring order, as in planned_ring.h. Times count from when every node has joined; in the soak's
/// world, from when they start.

namespace limb_ring::scenario {

using std::chrono::nanoseconds;
using wire::NodeId;

// ---- what is done ---------------------------------------------------------------------------

using fault::Fault;

/// Packets or interrupts under a name by which conditions speak of them.
struct Send {
  std::string name;
  std::vector<NodeId> from;               ///< each of them sends
  NodeId to{0};                           ///< or wire::kBroadcast
  unsigned size = 0;                      ///< bytes of data, 1 to 512, or one of these two:
  std::optional<std::uint8_t> interrupt;  ///< an INTP with this factor
  std::optional<std::uint8_t> input;      ///< what pulling this interrupt input sends, CPU or not
  std::uint8_t priority = 0;
  nanoseconds every{0};     ///< 0: all at once
  std::uint64_t count = 0;  ///< from each node; 0: one, or with `every` without end

  bool is_stream() const { return every.count() != 0; }
  /// How many each node sends.
  std::uint64_t times() const { return count != 0 ? count : is_stream() ? UINT64_MAX : 1; }
};

/// What only the world of `ring_sim soak` has: wires and cables that break, single slices, and sends that are given up.
struct SoakAction {
  enum class Kind : std::uint8_t {
    cut_wire,      ///< the node behind it learns of it at once, the one before it does not
    mend_wire,     ///< the same wire
    cut_cable,     ///< of a ring that folds back: the wires of both lines, and both ends learn of it at once
    mend_cable,    ///< the same cable
    lose_slice,    ///< the next slice that leaves onto the line does not arrive
    damage_slice,  ///< it arrives with wrong bits in one of its bytes
    cancel         ///< the program of a node has gone: what it has asked for is given up
  } kind = Kind::cut_wire;
  NodeId node{0};            ///< of the last; else the line or cable leads from it
  bool second_line = false;  ///< against ring order
  unsigned nth = 1;          ///< of the next slices, this one
  unsigned byte = 0;         ///< of a damaged slice, from 0; of a shorter one its last
  std::uint8_t bits = 1;     ///< that are flipped in it
};

// ---- what is seen ---------------------------------------------------------------------------

/// How long something may take: under the virtual clock, where times are exact; and live, where machines are busy.
struct Limit {
  nanoseconds sim{0}, live{0};
};
/// If a file gives one time for both, a live run allows this much more. (ours)
constexpr std::chrono::seconds kLiveGuard{5};

/// Whole numbers that are as expected; an end that is not given is open.
struct Range {
  std::optional<std::uint64_t> at_least, at_most;
  bool holds(std::uint64_t value) const { return (!at_least || value >= *at_least) && (!at_most || value <= *at_most); }
};

/// Who has to be in a state.
struct Who {
  enum class Kind { one, all, living } kind = Kind::all;
  NodeId node{0};  ///< Kind::one
};

/// The state of network controllers.
struct NodeIs {
  Who who;
  std::optional<core::NodeState> state;
  bool down = false;                  ///< dead or frozen, instead of a state
  std::optional<unsigned> ring_size;  ///< as learned by the node
};
/// What every other living node has been told, by beacons, of a CPU.
struct CpuIs {
  NodeId node{0};
  std::optional<wire::CpuState> state;
  std::optional<std::uint32_t> boots;
};
/// Every living node but the one behind it has been told of that broken line.
struct Located {
  NodeId before{0}, behind{0};
};
/// A counter of core/counters.h, of one node since its last start, or of all nodes together.
struct Counted {
  std::string counter;
  Who of;  ///< one or all
  Range range;
};
/// How many sends of that name have ended so.
struct Results {
  std::string send;
  core::Outcome are = core::Outcome::delivered;
  Range range;
};
/// How many packets of that name CPUs have taken; for an interrupt, how many pins were pulled.
struct Taken {
  std::string send;
  Range range;
};
/// The worst latency so far of delivered sends of that name, from the CPU's request to the confirmation.
struct Latency {
  std::string send;
  Limit at_most;
};

/// One thing that has to be seen of a ring.
struct Condition {
  std::variant<NodeIs, CpuIs, Located, Counted, Results, Taken, Latency> what;
  std::string words;  ///< as it stands in the file
};

// ---- the scenario ---------------------------------------------------------------------------

/// First the time, then the packets to wait for, then the action; each may be missing.
struct Step {
  std::optional<nanoseconds> at;     ///< from the start
  std::optional<nanoseconds> after;  ///< from the step before
  std::optional<Condition> when;
  Limit within;  ///< `when` has to hold by then; 0: at once
  std::variant<std::monostate, Fault, Send, SoakAction> action;
  std::string words;  ///< of the action, as it stands in the file
};

/// The alive_period of every CPU in a scenario: its daemon hears from it at least so often. (ours)
constexpr std::chrono::milliseconds kAlivePeriod{200};

/// What a scenario's ring is like under the virtual clock.
enum class World {
  usual,  ///< as a ring's file says, with models of CPUs
  soak    ///< as in `ring_sim soak` (SoakStage)
};

/// A scenario as its file says it.
struct Scenario {
  std::string path;
  std::string name;            ///< one line of what it is about
  config::RingConfig ring;     ///< every line has a rate
  bool rates_assumed = false;  ///< of some lines: the ring's file gives none
  bool only_sim = false;       ///< its author says so
  World world = World::usual;
  bool ends_mended = true;  ///< of the soak's world: it ends as SoakStage::end() says; false: with its last step
  std::uint64_t seed = 1;
  nanoseconds boot_time{std::chrono::milliseconds(20)};  ///< of a CPU, from a reset to its first word; not live
  std::vector<int> clocks;                               ///< of each node, millionths too fast; empty: all are right
  std::vector<NodeId> absent;                            ///< not there at the start
  std::vector<Step> steps;
  std::vector<Condition> always, never;  ///< from the start to the last step's end
  std::vector<std::size_t> sometimes;    ///< goals that are met by its end, by their place in sim::goals()
};

/// Whether the scenario, or its world, says what has to be seen. Otherwise it could fail only by a broken promise of
/// the ring.
bool expects_something(const Scenario& scenario);
/// Whether time passes in it: it ends with its last step; the soak's world goes on behind it until all is calm.
bool lasts(const Scenario& scenario);

/// What became of the sends of one name.
struct Tally {
  std::array<std::uint64_t, static_cast<std::size_t>(core::Outcome::cancelled) + 1> results{};  ///< by core::Outcome
  std::uint64_t taken = 0;  ///< by CPUs; of an interrupt, pins pulled
  core::Duration worst{0};  ///< from the request until it was confirmed, of what was delivered
};

}  // namespace limb_ring::scenario
