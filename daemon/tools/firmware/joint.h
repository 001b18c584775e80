#pragma once

#include "config/ring_config.h"
#include "tools/firmware/servo.h"
#include "tools/firmware/timestamps.h"

namespace limb_ring::firmware {

/// A servo that keeps to protocol.md section 9.1 (ours): without a command for `command_timeout` it goes to its
/// configured safe state. It starts there.
class Joint {
 public:
  enum class State {
    commanded,
    hold,  ///< safe: keeps the position it had when it went there
    damp   ///< safe: no torque; its velocity decays
  };

  Joint(const config::JointConfig& joint, const config::Firmware& firmware, nanoseconds command_timeout,
        nanoseconds now);

  /// Obeys from now on. @pre the target holds something
  void command(const ServoTarget& target, nanoseconds now);
  void go_safe();
  /// Simulates up to `now`. Where the command runs out on the way, it does so at its own time.
  void advance(nanoseconds now);

  State state() const { return state_; }
  const Servo& servo() const { return servo_; }
  bool slides() const { return slides_; }

 private:
  void step_to(nanoseconds time);

  Servo servo_;
  State safe_;
  State state_;
  bool slides_;
  nanoseconds command_timeout_;
  nanoseconds now_;
  nanoseconds commanded_until_{0};
};

}  // namespace limb_ring::firmware
