#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "judge/observation_file.h"
#include "judge/promise_judge.h"
#include "judge/replay.h"
#include "wire/pcapng.h"

namespace limb_ring::recorder {

/// One saved recording: a life of a node, or as much of it as is left.
class ReplayedLife {
 public:
  /// @throw std::runtime_error says what is wrong with it
  /// @param data see Replay
  ReplayedLife(std::string file, std::vector<std::uint8_t> saved, PacketData& data);

  const std::string& file() const { return file_; }
  const Title& title() const { return recording_.title; }
  wire::NodeId node() const { return title().settings.id; }
  Replay& replay() { return replay_; }
  /// `at` on the machine's steady clock, which all nodes of a host share.
  std::chrono::nanoseconds machine_time(core::Time at) const;
  std::chrono::nanoseconds began() const { return began_; }

 private:
  std::string file_;
  std::vector<std::uint8_t> saved_;
  Recording recording_;
  Replay replay_;
  std::chrono::nanoseconds began_;
};

/// All that was saved of a ring, replayed in the order of time. (ours)
class ReplayedRing {
 public:
  /// @param folder of `ringctl record save`
  /// @throw std::runtime_error names the file
  explicit ReplayedRing(const std::string& folder);

  std::vector<std::unique_ptr<ReplayedLife>>& lives() { return lives_; }
  const std::vector<std::unique_ptr<ReplayedLife>>& lives() const { return lives_; }
  /// Machine time of the very first record.
  std::chrono::nanoseconds began() const { return began_; }
  /// `machine_time` counted from began().
  std::chrono::nanoseconds after(std::chrono::nanoseconds machine_time) const { return machine_time - began_; }
  /// Does the next record of all, unless it is later than `until` after the first. Each life stops at its first
  /// difference.
  /// @return whose it was; null if nothing is left
  ReplayedLife* step(std::chrono::nanoseconds until);
  /// Of the packets that were replayed last.
  const PacketData& data() const { return data_; }

 private:
  PacketData data_;
  std::vector<std::unique_ptr<ReplayedLife>> lives_;
  std::chrono::nanoseconds began_{0};
};

/// Judges the ring's promises over all nodes of a replayed ring together. A recording may begin in the middle of a
/// life, and end with the process. What cannot be judged because of that is counted. (ours)
class ReplayedPromises {
 public:
  /// @param ring must outlive this
  explicit ReplayedPromises(ReplayedRing& ring, const promises::JudgeTimes& times = {},
                            core::Duration goes_on = std::chrono::milliseconds(50),
                            std::chrono::nanoseconds round = std::chrono::milliseconds(100));
  ~ReplayedPromises();

  /// That life has done one more record.
  void has_done(ReplayedLife& life);
  /// Nothing more will be done.
  void finish();

  const std::vector<promises::Breach>& breaches() const { return breaches_; }
  const promises::JudgeCounts& counts() const { return judge_.counts(); }

 private:
  class NodeHistory;

  void begin(ReplayedLife& life);
  void end(ReplayedLife& life);

  ReplayedRing& ring_;
  core::Duration goes_on_;
  std::chrono::nanoseconds round_, round_ends_;
  std::vector<promises::Breach> breaches_;
  promises::PromiseJudge judge_;
  std::map<ReplayedLife*, std::unique_ptr<NodeHistory>> histories_;
};

/// Writes what is on the lines of a replayed ring as pcapng, by the dates at which it was recorded. (ours)
class ReplayCapture {
 public:
  /// Both must outlive this.
  ReplayCapture(ReplayedRing& ring, std::ostream& out);
  ~ReplayCapture();

 private:
  class NodeTap;
  capture::PcapngWriter writer_;
  std::vector<std::unique_ptr<NodeTap>> taps_;  ///< of each life
};

}  // namespace limb_ring::recorder
