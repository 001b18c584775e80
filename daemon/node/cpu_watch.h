#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "core/time.h"
#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/expected.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"
#include "node/neighbour_watch.h"

namespace limb_ring::runtime {

/// Finds out what is wrong with the firmware of a node, by what its CPU sends, what it is given, and what it says of
/// itself. Time is an argument. What was found stays until the next CPU comes, but for what can mend itself: a sensor
/// that speaks again, commands that are obeyed. (ours)
class CpuWatch {
 public:
  static constexpr core::Duration kLook = std::chrono::seconds(1);
  /// A sensor or all joints that say nothing for so long, and for three of their periods, are silent.
  static constexpr core::Duration kSilence = std::chrono::seconds(2);
  static constexpr unsigned kCommands = 20;  ///< if none of these in a row is obeyed, it is not an accident
  static constexpr std::size_t kMostWarnings = 16;

  /// @param log is given each warning when it begins
  CpuWatch(const config::RingConfig& ring, const config::NodeConfig& node, std::function<void(const std::string&)> log)
      : ring_(ring),
        node_(node),
        state_rate_(ring.firmware.state_rate),
        log_(std::move(log)),
        heard_(node.sensors.size()) {}

  /// Another CPU has come.
  void begin(core::Time now);
  void end() { runs_ = false; }
  /// @name It has sent this on the joint channel
  ///@{
  void sent(const payload::Decoded<payload::JointState>& state, core::Time now);
  /// @param to whose sensor it may be: a bridge hands a sensor with a topic its values
  void sent(const payload::Decoded<payload::SensorReading>& reading, std::uint8_t to, core::Time now);
  ///@}
  /// It is given this on the joint channel.
  void given(payload::ByteView data);
  void spoke(core::Time now) { spoke_ = now; }
  /// It says of itself what is wrong: a sentence without its name.
  void told(const std::string& text);
  /// To be called now and then; looks every kLook.
  void look(core::Time now);

  const std::vector<Warning>& warnings() const { return warnings_; }
  std::uint64_t begun() const { return begun_; }  ///< warnings

 private:
  void warn(const char* rule, const std::string& text);
  /// @param text empty: any
  void mended(const char* rule, const std::string& text = {});
  void look_at(const std::string& what, double rate, core::Time heard, core::Time now);
  void look_at_commands();

  const config::RingConfig& ring_;
  const config::NodeConfig& node_;
  double state_rate_;
  std::function<void(const std::string&)> log_;
  bool runs_ = false;
  core::Time spoke_{}, looked_{}, state_heard_{};
  std::vector<core::Time> heard_;  ///< readings, by sensor
  bool has_states_ = false, commanded_ = false;
  unsigned commands_ = 0;               ///< since one was obeyed
  std::uint16_t refused_ = 0;           ///< by its last state
  std::uint16_t refused_at_first_ = 0;  ///< when the first of those commands came
  std::vector<Warning> warnings_;
  std::uint64_t begun_ = 0;
};

}  // namespace limb_ring::runtime
