#pragma once

#include <deque>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "config/fault.h"
#include "config/ring_config.h"
#include "config/watchdog.h"
#include "sim/scenario.h"
#include "sim/virtual_ring.h"

namespace limb_ring::scenario {

/// The CPUs of a virtual ring: what runs, hangs, is slow, reads nothing, crashes or boots, and what their network
/// controllers know of it. As in a live scenario each has promised to speak every kAlivePeriod, so a hang is known
/// after three of them.
class Cpus {
 public:
  /// All CPUs run at first. @param ring not yet started; must outlive this
  /// @param boot_time from a reset to the first word of the firmware
  Cpus(sim::VirtualRing& ring, core::Duration boot_time);
  Cpus(const Cpus&) = delete;
  Cpus& operator=(const Cpus&) = delete;

  /// Whether it runs, so that it asks its network controller to send what the scenario says.
  bool sends(NodeId id) const { return ring_.alive(id) && cpus_[id].running && cpus_[id].silenced_by == 0; }

  /// Breaks, restarts or cures it. Who babbles is a sender: that ends with generation().
  void begin(const fault::Fault& fault, NodeId id);
  /// One of its faults is over; the others last.
  void end(fault::Name fault, NodeId id);
  /// A CPU has taken a packet.
  void took_packet(NodeId id) {
    if (cpus_[id].slow) ring_.set_cpu_reads(id, false);
  }
  /// It begins to babble and goes on while generation() stays the same: until it is cured or restarted.
  std::uint64_t generation(NodeId id) const { return cpus_[id].generation; }
  /// As its reset pin does: everything for and from it is thrown away, and it boots.
  void reset(NodeId id);
  /// Its node has come up, and the CPU boots for the first time.
  void started(NodeId id);
  /// As its own network controller sees it.
  watchdog::CpuSighting sighting_of(NodeId id) const;

 private:
  void hang(NodeId id);
  /// Cures it: it no longer hangs, is slow or babbles, and it reads again.
  void resume(NodeId id);
  /// It takes one packet in each `period` from now on; 0: none.
  void read_slowly(NodeId id, core::Duration period);
  /// It has crashed, and all packets for and from it are gone. It is started again after the daemon's first back-off.
  void crash(NodeId id);
  void lose_process(NodeId id, wire::CpuState state, core::Duration later, void (Cpus::*next)(NodeId));
  struct Cpu {
    std::uint32_t boots = 1;
    wire::CpuState state = wire::CpuState::running;
    core::Time spoke_at{};  ///< last; of one that runs, when that began
    bool running = true;
    bool booted = true;
    bool boots_later = false;  ///< it has not booted, and nothing keeps it from that
    bool slow = false;
    std::optional<core::Duration> slowed_to;  ///< one packet in that time, 0: none; also while it hangs
    std::uint32_t silenced_by = 0;            ///< faults that keep it from sending, a set of fault::bit_of()
    std::uint64_t epoch = 0;                  ///< counts boots: the end of an earlier one does not count
    std::uint64_t generation = 0;             ///< a new one with each start and each cure
    std::uint64_t reading = 0;  ///< counts changes of how it reads: steps of an earlier slowness do not count
  };
  /// It has no process until its back-off is over.
  bool has_crashed(NodeId id) const { return cpus_[id].state == wire::CpuState::failed; }
  void tell(NodeId id, wire::CpuState state);
  void boot(NodeId id);
  /// It has none of its old faults.
  void run(NodeId id);
  /// It hangs no longer.
  void go_on(NodeId id);
  bool is_hung(NodeId id) const { return !cpus_[id].running && !cpus_[id].boots_later; }
  void read(NodeId id, bool reads);
  void read_one_and_wait(NodeId id, core::Duration period);

  sim::VirtualRing& ring_;
  core::Duration boot_time_;
  std::vector<Cpu> cpus_;
};

/// The ring's supervisor under a virtual clock: the watchdog of the daemon, evaluated once a beacon period, and its
/// orders given. Nodes are places in ring order. As in a live scenario every CPU is a child that has promised to speak,
/// so all are watched, and the supervisor is the configured node, else the first.
class Supervisor {
 public:
  /// All must outlive this. Does nothing unless the ring's policy is auto: a mere report changes nothing.
  Supervisor(const config::RingConfig& config, sim::VirtualRing& ring, const Cpus& cpus);
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// From now on. @pre not started yet
  void start();
  /// A node's daemon was started again. If it is the supervisor, it has forgotten all.
  void started(NodeId id);
  /// To be called for each event of the ring.
  void came(const core::Event& event, NodeId at);

 private:
  struct Reset {
    NodeId node;
    std::uint32_t token;
    watchdog::ResetOrder order;
  };

  core::Time now() const { return ring_.time_of(node_); }  ///< by its node's clock, as all that is known of others
  void evaluate();
  void evaluate_later();
  void reset(NodeId id);
  /// @param report how the reset ended; none: it goes on
  void finish(std::list<Reset>::iterator reset, const watchdog::ResetOrder::Report& report);
  watchdog::CpuSighting sighting_of(NodeId id) const;
  watchdog::CpuKnown cpu_of(NodeId id) const;
  watchdog::Watchdog fresh() const;

  const config::RingConfig& config_;
  sim::VirtualRing& ring_;
  const Cpus& cpus_;
  core::Duration beacon_;
  NodeId node_;
  const core::Membership* membership_;  ///< of that node since its last start, read without waking the node
  watchdog::Watchdog watchdog_;
  std::list<Reset> resets_;
};

/// Sends what a scenario says, and counts results by name. A CPU that does not run asks for nothing; an
/// interrupt input is pulled whatever its CPU does.
class Senders {
 public:
  /// @param ring outlives this @param cpu_sends whether the CPU of a node runs, so that it asks for what it has to send
  /// @param seed decides where in its period a stream begins
  Senders(sim::VirtualRing& ring, std::function<bool(NodeId)> cpu_sends, std::uint64_t seed)
      : ring_(ring), cpu_sends_(std::move(cpu_sends)), random_(seed) {}
  Senders(const Senders&) = delete;
  Senders& operator=(const Senders&) = delete;

  void begin(const Send& send);
  /// Sends the largest packets to all at the highest priority, one each `every` (0: default), until `over`.
  void babble(NodeId from, core::Duration every, std::function<bool()> over);
  /// All zero if nothing of that name was sent yet.
  const Tally& tally(const std::string& name) const;

  /// To be called for each event of the ring.
  void came(const core::Event& event, NodeId at);
  /// The send that a packet belongs to, as a number; nothing: a CPU's own.
  std::optional<std::size_t> send_of(const core::ReceivedPacket& packet) const;
  /// A CPU has taken a packet of that send.
  void taken(std::size_t send) { ++tallies_[send].taken; }

 private:
  struct Asked {
    std::size_t tally;
    core::Time at;
  };
  /// One node's part of a send.
  struct Job {
    Send send;
    NodeId from;
    std::size_t tally;
    std::uint64_t left;
    std::function<bool()> over{};  ///< of a babble
  };

  std::size_t index_of(const std::string& name);
  void ask_and_go_on(Job& job);
  void ask(const Job& job);

  sim::VirtualRing& ring_;
  std::function<bool(NodeId)> cpu_sends_;
  std::mt19937_64 random_;
  std::vector<std::string> names_;
  std::vector<Tally> tallies_;
  std::deque<Job> jobs_;                                                 ///< they stay where they are
  std::map<std::pair<NodeId, std::uint32_t>, Asked> asked_;              ///< by source and token
  std::map<std::pair<NodeId, std::uint8_t>, std::size_t> of_interrupt_;  ///< by source and factor, the last begun
};

/// Which fault of a node, or of its CPU, that lasts for a time is still there when that is over: another one may have
/// ended it, or taken its place, and is not to be ended with it. (ours)
class LastingFaults {
 public:
  /// To be told of every fault of a node or its CPU.
  void begins(fault::Name name, wire::NodeId node) {
    for (const fault::Word& lasting : fault::kWords)
      if (lasting.ended_by != 0 && (name == lasting.name || (lasting.ended_by & bit_of(name)) != 0))
        ++numbers_[{lasting.name, node}];
  }

  /// Of the fault of this name that the node has now; another one once that has ended or was replaced.
  unsigned number(fault::Name lasting, wire::NodeId node) const {
    const auto found = numbers_.find({lasting, node});
    return found == numbers_.end() ? 0 : found->second;
  }

 private:
  std::map<std::pair<fault::Name, wire::NodeId>, unsigned> numbers_;
};

}  // namespace limb_ring::scenario
