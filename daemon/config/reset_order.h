#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "config/reach.h"
#include "config/watchdog.h"
#include "core/events.h"

namespace limb_ring::watchdog {

/// What the node that orders a reset knows of the CPU: by beacons, or by its own CPU's state.
struct CpuKnown {
  std::uint32_t boots = 0;
  bool comes_back = true;  ///< somebody starts it again when it is killed
  bool absent = false;     ///< there is none to kill
  bool heard = true;       ///< beacons of its node have come lately
  Reach reach;
};
CpuKnown known_of(const CpuSighting& cpu, bool heard, const Reach& reach);

/// What is known of what a reset has done.
enum class Effect : std::uint8_t {
  none,     ///< it was not reset, or has not come back
  unknown,  ///< sent, and it may have arrived: nothing that can be heard from here tells
  seen      ///< a higher CPU boot number was heard
};
const char* to_string(Effect effect);

/// How the reset of a CPU ended.
struct ResetReport {
  Effect effect = Effect::none;
  std::string message;       ///< for people
  core::SendEnded ended;     ///< of the INTP; lost where it has not ended yet
  std::uint32_t boots = 0;   ///< of that CPU, as last heard
  core::Duration lasted{0};  ///< from the order to this report
  bool success() const { return effect == Effect::seen; }
};

/// One reset under way: an INTP to the reset pin, then a higher boot number in the beacons of its node. (ours,
/// protocol.md section 5.5) An INTP that does not come home, in an open chain or lost, may have arrived all the same:
/// where that node can still be heard its boot number tells.
///
/// No IO and no clock; the owner calls timed_out() when its time is over.
class ResetOrder {
 public:
  using Report = std::optional<ResetReport>;

  ResetOrder(const CpuKnown& before, core::Time now) : before_(before), begun_(now) {
    report_.boots = before.boots;
    report_.ended.outcome = core::Outcome::lost;
  }

  /// The INTP has ended. @return how the reset ended, if it is over now
  Report interrupt_ended(const core::SendEnded& ended, const CpuKnown& cpu, core::Time now);
  /// Something new may be known of the CPU.
  Report cpu_changed(const CpuKnown& cpu, core::Time now);
  ResetReport timed_out(core::Time now);

 private:
  enum class Phase : std::uint8_t { sent, pulled, doubtful };

  Report in_doubt(const CpuKnown& cpu, core::Time now);
  ResetReport end(Effect effect, const std::string& message, core::Time now);

  CpuKnown before_;
  core::Time begun_;
  Phase phase_ = Phase::sent;
  ResetReport report_;
};

}  // namespace limb_ring::watchdog
