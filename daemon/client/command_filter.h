#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "io/wall_clock.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/packet_type.h"

namespace limb_ring::firmware {

using std::chrono::nanoseconds;

/// One instant on both clocks. Monotonic time drives everything that happens here; wall time only
/// stamps what goes out and judges the stamps that come in, which are another node's.
struct Timestamps {
  nanoseconds monotonic{0};  ///< CLOCK_MONOTONIC
  std::int64_t wall_ns = 0;  ///< CLOCK_REALTIME, ns since 1970
};

/// What becomes of a command.
enum class Verdict : std::uint8_t {
  obey,
  expired,   ///< later than stamp + valid_for: this CPU was frozen, or the packet was held up
  early,     ///< stamped further ahead than valid_for: the clocks of the two hosts disagree
  older,     ///< not newer than the last one obeyed
  stopped,   ///< a stop is latched, and this does not resume, or was given before the stop
  unfit,     ///< for more joints than this node has
  malformed  ///< the bytes are not a command
};
constexpr std::size_t kVerdicts = static_cast<std::size_t>(Verdict::malformed) + 1;
const char* to_string(Verdict verdict);

/// Lets a command through only if it may be acted on now (ours, protocol.md section 9.1).
///
/// Stamps are of the wall clock, the only one that nodes of several hosts share. Here each becomes an instant of the
/// monotonic clock, so that a step of this host's wall clock changes nothing. Order is by that instant, then by
/// sequence: a commander that restarts counts from 0, but its stamps go on. The order is remembered for `memory` only,
/// so that another host's wall clock that is set back does not lock commands out; beyond that, expiry alone protects.
class CommandFilter {
 public:
  explicit CommandFilter(nanoseconds memory) : memory_(memory) {}

  /// Remembers what it lets through, and ends the stop if that resumes.
  Verdict judge(const payload::JointCommand& command, const Timestamps& now);
  /// Latches a stop until a command that resumes and was given later than this.
  void stop(const Timestamps& now) { stopped_at_ = now.monotonic; }
  bool stopped() const { return stopped_at_.has_value(); }

 private:
  struct Obeyed {
    std::int64_t stamp_ns;
    nanoseconds given;
    std::uint16_t sequence;
    nanoseconds at;
  };

  bool is_older(const payload::JointCommand& command, nanoseconds given, nanoseconds now) const;

  process::WallOffset wall_;

  nanoseconds memory_;
  std::optional<Obeyed> last_;
  std::optional<nanoseconds> stopped_at_;
};

/// What a packet on the joint channel commands that node to do, or why it cannot be read; nothing: it is not a command,
/// or one of other nodes.
inline std::optional<payload::Decoded<payload::JointCommand>> command_for(std::uint8_t node, payload::ByteView packet) {
  using payload::PacketType;
  if (payload::is_type(packet, PacketType::joint_command)) return payload::decode_joint_command(packet);
  if (!payload::is_type(packet, PacketType::command_set)) return std::nullopt;
  const auto set = payload::decode_command_set(packet);
  if (!set) return payload::Decoded<payload::JointCommand>(set.error());
  auto command = set->to(node);
  if (!command) return std::nullopt;
  return payload::Decoded<payload::JointCommand>(std::move(*command));
}

}  // namespace limb_ring::firmware
