
#include "client/command_filter.h"

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
  wall_.set(now.wall_ns - now.monotonic.count(), now.monotonic);
  const nanoseconds age = wall_.age_of(command.stamp_ns, now.monotonic);
  const nanoseconds valid_for = std::chrono::microseconds(command.valid_for_us);
  if (age > valid_for) return Verdict::expired;
  if (age < -valid_for) return Verdict::early;
  const nanoseconds given = now.monotonic - age;
  if (is_older(command, given, now.monotonic)) return Verdict::older;
  if (stopped_at_ && (!command.resume || given <= *stopped_at_)) return Verdict::stopped;
  last_ = Obeyed{command.stamp_ns, given, command.sequence, now.monotonic};
  stopped_at_.reset();
  return Verdict::obey;
}

bool CommandFilter::is_older(const payload::JointCommand& command, nanoseconds given, nanoseconds now) const {
  if (!last_ || now - last_->at >= memory_) return false;
  // The stamps themselves say which is later; only across a step of the clock the instants do.
  const nanoseconds by_stamp(command.stamp_ns - last_->stamp_ns), by_instant = given - last_->given;
  const bool stepped = std::chrono::abs(by_stamp - by_instant) >= process::WallOffset::kStep;
  const nanoseconds later = stepped ? by_instant : by_stamp;
  if (later.count() != 0) return later.count() < 0;
  return static_cast<std::int16_t>(command.sequence - last_->sequence) <= 0;
}

}  // namespace limb_ring::firmware
