#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/command_filter.h"
#include "limb_ring/host_port.h"
#include "limb_ring/joint_node.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"

namespace limb_ring::firmware {

/// The joints of one node: commands in, goals for whoever moves them, their state out (protocol.md section 9.1). No IO;
/// time is an argument.
///
/// A joint obeys a command for `command_timeout`, then it goes to its safe state, in which it also starts.
class Limb {
 public:
  using Joint = payload::JointState::Joint;

  /// @param at_once joints are moved up to each instant at which a goal changes, too
  /// @throw std::invalid_argument if the node has more joints than one packet carries
  Limb(const NodeSetup& setup, bool at_once, nanoseconds now);

  /// Who moves them. @pre it is set before time goes on, if there are joints
  void moved_by(JointNode::Step step) { step_ = std::move(step); }

  /// What a packet says to this node. Every verdict is counted; all but `obey` as refused, too.
  Verdict command(const payload::Decoded<payload::JointCommand>& command, const Timestamps& now);
  /// All joints to their safe states, until a command resumes.
  void stop(const Timestamps& now);
  /// Time has come so far.
  void advance(nanoseconds now);
  /// The state at `now`, under the next sequence number. @throw std::logic_error as JointNode::run()
  payload::JointState sample(const Timestamps& now);
  /// So many samples are not taken: their sequence numbers stay unused, so the receiver knows.
  void leave_out(std::uint64_t samples) { sequence_ = static_cast<std::uint16_t>(sequence_ + samples); }

  const std::vector<Joint>& joints() const { return joints_; }
  const std::vector<JointGoal>& goals() const { return goals_; }
  bool stopped() const { return filter_.stopped(); }
  std::uint64_t count(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }

 private:
  Verdict judge(const payload::Decoded<payload::JointCommand>& command, const Timestamps& now);
  void obey(const payload::JointCommand& command, nanoseconds now);
  void go_safe(std::size_t joint);
  void go_safe_at(nanoseconds now);
  void move_to(nanoseconds now);
  void add_mode(payload::JointState::Mode& mode) const;

  std::string node_;
  std::vector<NodeJoint> limits_;
  nanoseconds command_timeout_;
  bool at_once_;
  JointNode::Step step_;
  std::vector<Joint> joints_;
  std::vector<JointGoal> goals_;
  std::vector<nanoseconds> commanded_until_;
  nanoseconds moved_to_;
  CommandFilter filter_;
  std::array<std::uint64_t, kVerdicts> counts_{};  ///< by Verdict
  std::uint16_t sequence_ = 0;
  std::uint16_t refused_ = 0;
  bool refused_since_sample_ = false;
};

/// Something done at a fixed rate, at the multiples of its period on the clock. So all CPUs of a host sample in the
/// same instant, as the CPUs of a robot do by a sync interrupt, and their packets travel together. A process that was
/// not scheduled makes up for the last kMadeUp deadlines, or those of the last kMadeUpFor if these are more, since the
/// timer of a real CPU would have met them; earlier ones are left out and counted.
class Periodic {
 public:
  static constexpr std::int64_t kMadeUp = 8;
  static constexpr std::chrono::milliseconds kMadeUpFor{32};  ///< a desktop pauses a process for so long
  /// A deadline that has come.
  struct Due {
    nanoseconds at;
    std::uint64_t left_out;  ///< deadlines before this one that were not made up for
  };

  /// First due at the first multiple of the period behind `start`. @pre rate_hz > 0
  Periodic(double rate_hz, nanoseconds start)
      : period_(static_cast<std::int64_t>(1e9 / rate_hz)), due_((start / period_ + 1) * period_) {}

  nanoseconds due() const { return due_; }
  /// @return once per deadline that has come, in order
  std::optional<Due> take(nanoseconds now) {
    if (now < due_) return std::nullopt;
    const std::int64_t left_out = std::max<std::int64_t>(0, (now - due_) / period_ + 1 - made_up());
    const Due due{due_ + left_out * period_, static_cast<std::uint64_t>(left_out)};
    left_out_ += due.left_out;
    due_ = due.at + period_;
    return due;
  }
  std::uint64_t left_out() const { return left_out_; }

 private:
  std::int64_t made_up() const { return std::max<std::int64_t>(kMadeUp, kMadeUpFor / period_); }

  nanoseconds period_;
  nanoseconds due_;
  std::uint64_t left_out_ = 0;
};

/// The firmware without its IO: packets, interrupts and time go in, packets come out.
///
/// States go out at priority 0 and state_rate, readings at the rate and priority of
/// their sensor, all on channel 2. A sample of either kind is left out, and counted, while 64
/// packets are without a result: fresh values are worth more than old ones in a queue. What is left
/// out is missing in the sequence numbers.
class NodeCpu {
 public:
  struct Outgoing {
    std::uint8_t destination = 0;
    std::uint8_t priority = 0;
    std::uint8_t channel = 0;
    std::vector<std::uint8_t> data;
  };
  struct Counters {
    std::uint64_t sent = 0;
    std::uint64_t not_delivered = 0;  ///< results other than `delivered`
    std::uint64_t skipped = 0;        ///< samples left out, the ring being too slow
    std::uint64_t unreadable = 0;     ///< samples that could not be put into bytes
    std::uint64_t ignored = 0;        ///< packets that are nothing for this CPU
    std::uint64_t stops = 0;
    std::uint64_t notifies = 0;
  };

  /// @param at_once as Limb
  /// @throw std::invalid_argument if the node has more joints than one packet carries
  NodeCpu(NodeSetup setup, bool at_once, const Timestamps& now);

  void moved_by(JointNode::Step step) { limb_.moved_by(std::move(step)); }
  /// @throw std::invalid_argument if no sensor has that name; it names those that there are
  void measured_by(const std::string& sensor, std::function<SensorValues()> measure);
  /// The first sensor that nobody measures, and that no topic gives values; empty: none.
  std::string unmeasured() const;

  /// A command, or a value for a sensor with a topic.
  /// @return the command that was obeyed; nothing if none was
  std::optional<payload::JointCommand> receive_joint_data(const Packet& packet, const Timestamps& now);
  /// A packet that is nothing for this CPU.
  void ignore() { ++counters_.ignored; }
  void receive(const Interrupt& interrupt, const Timestamps& now);
  void receive(const limb_ring::Result& result);
  /// Goes on up to `now` and samples what is due.
  void advance(const Timestamps& now);
  /// What is to be sent; each of them gives one Result later.
  std::vector<Outgoing> take_outgoing();
  /// When advance() is to be called next, at the latest; nothing if never.
  std::optional<nanoseconds> due() const;

  const NodeSetup& setup() const { return setup_; }
  const Limb& limb() const { return limb_; }
  const Counters& counters() const { return counters_; }
  /// One line for people.
  std::string summary() const;

 private:
  struct Sensor {
    payload::SensorReading next;  ///< without its values
    std::uint8_t priority;
    Periodic periodic;
    std::function<SensorValues()> measure;
  };
  void sample_states(const Timestamps& now);
  void sample(Sensor& sensor, const Timestamps& now);
  bool take_value(const Packet& packet, const Timestamps& now);
  void send_reading(Sensor& sensor, const SensorValues& values, std::int64_t stamp_ns);
  bool may_send();
  void send(const payload::Encoded& bytes, std::uint8_t priority);
  std::uint64_t left_out() const;

  NodeSetup setup_;
  Limb limb_;
  std::optional<Periodic> states_;  // none without joints
  std::vector<Sensor> sensors_;
  std::vector<Outgoing> outgoing_;
  std::size_t without_result_ = 0;
  Counters counters_;
};

}  // namespace limb_ring::firmware
