#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/payload/joint_state.h"
#include "tools/firmware/command_filter.h"
#include "tools/firmware/joint.h"
#include "tools/firmware/timestamps.h"

namespace limb_ring::firmware {

/// The joints of one node: commands in, their state out. No IO; time is an argument.
class Limb {
 public:
  /// @throw std::invalid_argument where the node has more joints than one packet carries
  Limb(const config::NodeConfig& node, const config::Firmware& firmware, nanoseconds command_timeout,
       const Timestamps& now);

  /// What a packet says to this node. Every verdict is counted; all but `obey` as refused, too.
  Verdict command(const payload::Decoded<payload::JointCommand>& command, const Timestamps& now);
  /// All joints to their safe states, until a command resumes.
  void stop(const Timestamps& now);
  void advance(nanoseconds now);
  /// The state at `now`, under the next sequence number.
  payload::JointState sample(const Timestamps& now);
  /// So many samples are not taken: their sequence numbers stay unused, so the receiver knows.
  void leave_out(std::uint64_t samples) { sequence_ = static_cast<std::uint16_t>(sequence_ + samples); }

  const std::vector<Joint>& joints() const { return joints_; }
  bool stopped() const { return filter_.stopped(); }
  std::uint64_t count(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }

 private:
  Verdict judge(const payload::Decoded<payload::JointCommand>& command, const Timestamps& now);
  void obey(const payload::JointCommand& command, nanoseconds now);
  void add_mode(payload::JointState::Mode& mode) const;

  std::vector<Joint> joints_;
  CommandFilter filter_;
  std::array<std::uint64_t, kVerdicts> counts_{};  ///< by Verdict
  std::uint16_t sequence_ = 0;
  std::uint16_t refused_ = 0;
  bool refused_since_sample_ = false;
};

}  // namespace limb_ring::firmware
