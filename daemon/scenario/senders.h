#pragma once

#include <deque>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "scenario/cpus.h"
#include "scenario/tally.h"

namespace limb_ring::scenario {

/// Sends what a scenario says, and counts results by name. A CPU that does not run asks for nothing; an
/// interrupt input is pulled whatever its CPU does.
class Senders {
 public:
  /// All must outlive this. @param seed decides where in its period a stream begins
  Senders(sim::VirtualRing& ring, const Cpus& cpus, std::uint64_t seed) : ring_(ring), cpus_(cpus), random_(seed) {}
  Senders(const Senders&) = delete;
  Senders& operator=(const Senders&) = delete;

  void begin(const Send& send);
  /// Sends the largest packets to all at the highest priority, one each `every` (0: default), while the CPU babbles.
  void babble(NodeId from, core::Duration every);
  /// All zero where nothing of that name was sent yet.
  const Tally& tally(const std::string& name) const;

  /// What the ring gives out.
  void came(const core::Event& event, NodeId at);
  void came(const core::ReceivedPacket& packet) { ++tallies_[packet.data[0]].taken; }

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
    std::optional<std::uint64_t> generation{};  ///< of a babble: it ends with it
  };

  bool over(const Job& job) const { return job.generation && *job.generation != cpus_.generation(job.from); }
  std::size_t index_of(const std::string& name);
  void ask_and_go_on(Job& job);
  void ask(const Job& job);

  sim::VirtualRing& ring_;
  const Cpus& cpus_;
  std::mt19937_64 random_;
  std::vector<std::string> names_;
  std::vector<Tally> tallies_;
  std::deque<Job> jobs_;                                                 ///< they stay where they are
  std::map<std::pair<NodeId, std::uint32_t>, Asked> asked_;              ///< by source and token
  std::map<std::pair<NodeId, std::uint8_t>, std::size_t> of_interrupt_;  ///< by source and factor, the last begun
};

}  // namespace limb_ring::scenario
