#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sim/scenario.h"
#include "sim/tally.h"
#include "sim/virtual_ring.h"

namespace limb_ring::scenario {

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
  /// All zero where nothing of that name was sent yet.
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

}  // namespace limb_ring::scenario
