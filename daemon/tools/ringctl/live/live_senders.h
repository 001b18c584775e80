#pragma once

#include <deque>
#include <map>
#include <random>

#include "sim/scenario.h"
#include "sim/tally.h"
#include "tools/ringctl/live/live_nodes.h"

namespace limb_ring::ringctl {

/// Sends what a scenario says on live daemons, as a tool beside each node's CPU, and keeps account by name. A CPU
/// that does not run asks for nothing; an interrupt input is pulled whatever its CPU does.
///
/// At most kMostWaiting packets of a stream wait at a node. So on a busy machine a stream is late, instead of its
/// packets being rejected.
class LiveSenders {
 public:
  using Clock = LiveNodes::Clock;
  static constexpr unsigned kMostWaiting = 16;

  /// All outlive this. @param seed of where in its period a stream begins
  LiveSenders(const scenario::Scenario& scenario, LiveNodes& nodes, std::uint64_t seed);

  void begin(const scenario::Send& send);
  /// Asks for what is due by now. @return when the next is
  Clock::time_point act();
  /// Whether a CPU is told to hang.
  void set_hung(std::size_t place, bool hung) { hung_[place] = hung; }

  void came(std::size_t place, const Message& message);
  /// The counts of a named send; `taken` counts only pins here.
  const scenario::Tally& tally(const std::string& send) const { return tallies_[mark_of(send)]; }
  /// The first byte of a send's packets.
  std::uint8_t mark_of(const std::string& send) const;

 private:
  /// One node's part of a send.
  struct Job {
    scenario::Send send;
    std::size_t from;
    std::uint8_t mark;
    std::uint64_t left;
    Clock::time_point due;
    unsigned waiting = 0;  ///< for their results
  };
  struct Asked {
    Job* job;
    Clock::time_point at;
  };

  bool can_send(const Job& job);
  void ask(Job& job);
  std::uint32_t ask(HostPort& port, const Job& job);
  std::uint8_t id_of(std::uint8_t place_or_all) const;
  void came(std::size_t place, const Result& result);
  void came(const Observed& seen);

  const scenario::Scenario& scenario_;
  LiveNodes& nodes_;
  std::mt19937_64 random_;
  std::vector<bool> hung_;
  std::vector<std::string> names_;
  std::vector<scenario::Tally> tallies_;
  std::deque<Job> jobs_;                                                        ///< they stay where they are
  std::map<std::pair<std::size_t, std::uint32_t>, Asked> asked_;                ///< by source and token
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::uint8_t> of_interrupt_;  ///< by source's id and factor
};

}  // namespace limb_ring::ringctl
