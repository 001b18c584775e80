#include "tools/ringctl/result_wait.h"

#include "limb_ring/ring_directory.h"
#include "ring/lock_files.h"
#include "tools/ringctl/answers.h"
#include "tools/ringctl/connect_node.h"
#include "tools/ringctl/ring_clock.h"

namespace limb_ring::ringctl {

namespace {

constexpr std::chrono::seconds kGuard{120};  // well above the default time-outs of a send

std::string seconds(std::chrono::nanoseconds time) {
  return std::to_string(std::chrono::floor<std::chrono::seconds>(time).count()) + " s";
}

}  // namespace

void ResultWait::check() const {
  const auto waited = std::chrono::steady_clock::now() - begun_;
  if (waited >= kAnswerTime && live::is_frozen(ring_directory(port_.ring()), port_.id()))
    throw gone(port_, "no result within " + seconds(kAnswerTime) + ": its daemon is frozen");
  if (waited < kGuard) return;
  const std::string standing = standing_clock(port_.ring());
  throw gone(port_, "no result within " + seconds(kGuard) + (standing.empty() ? "" : ": " + standing));
}

}  // namespace limb_ring::ringctl
