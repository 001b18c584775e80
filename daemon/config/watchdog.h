#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "core/events.h"
#include "core/membership/peers.h"
#include "core/ring_order.h"
#include "core/settings.h"

namespace limb_ring::watchdog {

/// What the supervisor knows of a CPU: the last beacon of its network controller, or for the
/// supervisor's own CPU what its own network controller says.
struct CpuSighting {
  std::optional<core::Time> heard_at;  ///< of that beacon; none: never heard
  std::uint32_t boots = 0;
  wire::CpuState state = wire::CpuState::none;
  std::chrono::milliseconds silent{0};  ///< since it last spoke, when the beacon was sent
  bool comes_back = true;               ///< somebody starts it again when a reset kills it
  std::uint64_t node_boot = 0;          ///< boot number of its network controller; 0: it is our own
};

/// The sighting of another node's CPU, from the beacons of its node.
CpuSighting sighting_of(const core::Peer& peer);

/// Beacons of its node have come lately: one or two may be late on a busy machine, or lost. (ours)
inline bool is_heard(const CpuSighting& cpu, core::Time now, core::Duration beacon) {
  return cpu.heard_at && now - *cpu.heard_at < wire::kMissedBeacons * beacon;
}

/// The CPUs that have promised to speak, by node id, in ring order.
std::vector<wire::NodeId> watched_in(const config::RingConfig& ring);

/// What the supervisor believes of a CPU. (ours, protocol.md section 8.13)
enum class CpuVerdict {
  unheard,  ///< nothing was heard of its node yet
  booting,  ///< not there yet, or silent within the grace after its start
  alive,
  hung,        ///< its network controller is heard, and says that the CPU is silent; until it speaks or has booted
  absent,      ///< the CPU has no process; a reset pin cannot help
  unreachable  ///< no beacon comes any more, so nobody knows about the CPU: its node is down, or a line is broken
};
const char* to_string(CpuVerdict verdict);
const char* to_string(config::SupervisorConfig::Policy policy);

/// What the supervisor keeps of one CPU.
struct WatchedCpu {
  wire::NodeId node{0};
  CpuVerdict verdict = CpuVerdict::unheard;
  core::Time since{};           ///< of the verdict
  std::uint64_t hangs = 0;      ///< times it was found hung
  std::uint64_t resets = 0;     ///< ordered
  std::uint64_t confirmed = 0;  ///< of those: a higher CPU boot number was heard
  unsigned tries = 0;           ///< resets since it last ran for long
  bool given_up = false;        ///< hung, and not reset any more
  std::string last;             ///< why the verdict, or what was done since; for people
  std::string reset_reason;     ///< of the last reset
};

/// Watches the CPUs that declare an alive period, and resets the hung ones. A hung CPU is told
/// from a dead node by the beacons (patent) and cured by its reset pin (paper); grace, bounded tries
/// and back-off are ours (protocol.md section 8.13).
///
/// No IO and no clock: sightings and time go in, findings and orders come out.
class Watchdog {
 public:
  using Policy = config::SupervisorConfig::Policy;
  using SightingOf = std::function<CpuSighting(wire::NodeId)>;

  /// A change of what is known of one CPU.
  struct Finding {
    wire::NodeId node{0};
    CpuVerdict verdict = CpuVerdict::unheard;
    std::string what;
  };
  struct Round {
    std::vector<Finding> findings;
    std::vector<wire::NodeId> resets;  ///< to be ordered now; reset_ended() is to follow for each
  };

  /// @param watched nodes in ring order
  /// @param missing_after a node without a beacon for so long is unreachable
  Watchdog(const config::SupervisorConfig& settings, core::Duration missing_after,
           const std::vector<wire::NodeId>& watched);

  /// To be called regularly, several times within `missing_after`.
  Round evaluate(const SightingOf& sighting_of, core::Time now);
  /// A reset has ended. Whether it helped is known by the boot number, at the next evaluation.
  /// @return a failure, as a finding
  std::optional<Finding> reset_ended(wire::NodeId node, bool success, const std::string& message, core::Time now);

  Policy policy() const { return settings_.policy; }
  /// A reset that is not confirmed within this has failed.
  std::chrono::milliseconds confirm_within() const { return settings_.grace; }
  std::vector<WatchedCpu> watched() const;

 private:
  struct Entry : WatchedCpu {
    std::optional<std::uint32_t> boots;  ///< as last heard
    core::Time booted_at{};              ///< that number was heard first
    std::string boot;                    ///< the same, for people
    core::Time next_reset{};             ///< not before
    bool under_reset = false;            ///< a reset was ordered, and it has neither booted nor spoken since
    bool order_out = false;
  };

  void evaluate(Entry& cpu, const CpuSighting& seen, core::Time now);
  void judge(Entry& cpu, const CpuSighting& seen, core::Time now);
  void speaks(Entry& cpu, core::Time now);
  void booted(Entry& cpu, std::uint32_t boots, core::Time now);
  void enter(Entry& cpu, CpuVerdict verdict, const std::string& why, core::Time now);
  void cure(Entry& cpu, const CpuSighting& seen, core::Time now);
  void order(Entry& cpu, const CpuSighting& seen, core::Time now);
  void give_up(Entry& cpu, const std::string& why);
  void find(Entry& cpu, const std::string& what);
  core::Duration wait_after(unsigned tries) const { return settings_.backoff * (1 << (tries - 1)); }
  std::string of_tries(const Entry& cpu) const;

  config::SupervisorConfig settings_;
  core::Duration missing_after_;
  std::vector<Entry> cpus_;
  std::optional<core::Time> looked_at_;
  bool slept_ = false;  ///< this evaluation is so late that beacons may be waiting unread
  Round round_;
};

/// Between two nodes: whether packets of the first reach the second, and packets of the second the first.
/// In an open chain it is one of the two, never both. (ours)
struct Reach {
  bool sends = true;  ///< packets of the one reach the other
  bool hears = true;  ///< beacons of the other reach the one
};

/// From node `from` to node `to`.
/// @param order ids in ring order. @pre all nodes named are in it
/// @param broken the broken line; none: the ring is closed, and everything reaches everybody
Reach reach_of(const core::RingOrder& order, const std::optional<core::BrokenLine>& broken, wire::NodeId from,
               wire::NodeId to);

/// What the node that orders a reset knows of the CPU: by beacons, or by its own CPU's state.
struct CpuKnown {
  std::uint32_t boots = 0;
  bool comes_back = true;  ///< somebody starts it again when it is killed
  bool absent = false;     ///< there is none to kill
  bool heard = true;       ///< beacons of its node have come lately
  Reach reach;
  std::uint64_t node_boot = 0;  ///< as CpuSighting's
  bool runs = false;
};
CpuKnown known_of(const CpuSighting& cpu, bool heard, const Reach& reach);

/// What is known of what a reset has done.
enum class Effect : std::uint8_t {
  none,     ///< it was not reset, or has not come back
  unknown,  ///< sent, and it may have arrived: nothing that can be heard from here tells
  seen      ///< a higher CPU boot number was heard
};
const char* to_string(Effect effect);

/// How the reset of a CPU ended.
struct ResetReport {
  Effect effect = Effect::none;
  std::string message;       ///< for people
  core::SendEnded ended;     ///< of the INTP; lost if it has not ended yet
  std::uint32_t boots = 0;   ///< of that CPU, as last heard
  core::Duration lasted{0};  ///< from the order to this report
  bool success() const { return effect == Effect::seen; }
};

/// One reset under way: an INTP to the reset pin, then a higher boot number in the beacons of its node: of its CPU, or
/// of the node itself if CPU and network controller are one firmware. (ours, protocol.md section 5.5) An INTP that
/// does not come home, in an open chain or lost, may have arrived all the same: if that node can still be heard its
/// boot number tells.
///
/// No IO and no clock; the owner calls timed_out() when its time is over.
class ResetOrder {
 public:
  using Report = std::optional<ResetReport>;

  ResetOrder(const CpuKnown& before, core::Time now) : before_(before), begun_(now) {
    report_.boots = before.boots;
    report_.ended.outcome = core::Outcome::lost;
  }

  /// The INTP has ended. @return how the reset ended, if it is over now
  Report interrupt_ended(const core::SendEnded& ended, const CpuKnown& cpu, core::Time now);
  /// Something new may be known of the CPU.
  Report cpu_changed(const CpuKnown& cpu, core::Time now);
  ResetReport timed_out(core::Time now);

 private:
  enum class Phase : std::uint8_t { sent, pulled, doubtful };

  Report in_doubt(const CpuKnown& cpu, core::Time now);
  ResetReport end(Effect effect, const std::string& message, core::Time now);

  CpuKnown before_;
  core::Time begun_;
  Phase phase_ = Phase::sent;
  ResetReport report_;
};

}  // namespace limb_ring::watchdog
