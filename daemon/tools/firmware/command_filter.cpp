#include "tools/firmware/command_filter.h"

namespace limb_ring::firmware {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::obey:
      return "obeyed";
    case Verdict::expired:
      return "expired";
    case Verdict::early:
      return "stamped in the future";
    case Verdict::older:
      return "older than the last";
    case Verdict::stopped:
      return "held by a stop";
    case Verdict::unfit:
      return "for more joints than there are";
    case Verdict::malformed:
      return "malformed";
  }
  return "unknown";
}

Verdict CommandFilter::judge(const payload::JointCommand& command, const Timestamps& now) {
  const std::int64_t age = now.wall_ns - command.stamp_ns;  // both are >= 0: no overflow
  const std::int64_t valid_for = std::int64_t{command.valid_for_us} * 1000;
  if (age > valid_for) return Verdict::expired;
  if (age < -valid_for) return Verdict::early;
  if (is_older(command, now.monotonic)) return Verdict::older;
  if (held_by_stop(command, now)) return Verdict::stopped;
  last_ = Obeyed{command.stamp_ns, command.sequence, now.monotonic};
  stopped_at_.reset();
  return Verdict::obey;
}

bool CommandFilter::is_older(const payload::JointCommand& command, nanoseconds now) const {
  if (!last_ || now - last_->at >= memory_) return false;
  if (command.stamp_ns != last_->stamp_ns) return command.stamp_ns < last_->stamp_ns;
  return static_cast<std::int16_t>(command.sequence - last_->sequence) <= 0;
}

bool CommandFilter::held_by_stop(const payload::JointCommand& command, const Timestamps& now) const {
  if (!stopped_at_) return false;
  const nanoseconds given_at = now.monotonic - nanoseconds(now.wall_ns - command.stamp_ns);
  return !command.resume || given_at <= *stopped_at_;
}

}  // namespace limb_ring::firmware
