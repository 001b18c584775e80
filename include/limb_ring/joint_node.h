#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"

namespace limb_ring {

/// A joint as the ring's file and its URDF give it. It turns: rad, rad/s, N m; or it slides: m, m/s, N.
struct NodeJoint {
  std::string name;
  bool slides = false;
  double lower = 0, upper = 0;  ///< limits of the position
  double velocity = 0;          ///< limit of the speed, both ways
  double effort = 0;            ///< limit of the torque or force, both ways
  double initial = 0;           ///< position at the start
  bool damps = false;           ///< its safe state: let go with damping; false: hold the position
};

/// A sensor as the ring's file gives it.
struct NodeSensor {
  std::string name;
  bool imu = true;        ///< false: a force-torque sensor
  double rate = 0;        ///< Hz
  unsigned priority = 1;  ///< of its packets, 0 is the highest
  std::string csv = {};   ///< a recording of it, which limb_firmware plays; empty: none
  /// The ROS topic that its values come from, by way of the bridge; empty: none. JointNode sends each value that comes
  /// as a reading, at once, unless on_sensor() measures.
  std::string topic = {};
};

/// What the ring's file says about one node and its firmware. It comes from the daemon, as the daemon read it at its
/// start.
struct NodeSetup {
  std::uint8_t id = 0;
  std::string name;
  std::vector<NodeJoint> joints;                ///< in the order of states and commands
  std::vector<NodeSensor> sensors;              ///< in the order of readings
  double state_rate = 100;                      ///< Hz, of joint states
  double bandwidth = 8, damping = 0.9;          ///< of simulated servos: Hz, and ratio
  std::chrono::nanoseconds command_timeout{0};  ///< after this time without a command a joint goes to its safe state
  std::uint8_t state_to = 0;                    ///< node that states and readings go to
  std::chrono::milliseconds alive_period{200};  ///< the daemon hears from it at least this often
};

/// What a joint must do now, within its limits.
struct JointGoal {
  enum class State : std::uint8_t {
    commanded,  ///< what is given below
    hold,       ///< safe: stay at `position`, where it was when it became safe
    damp        ///< safe: no torque, velocity decays; nothing is given
  } state = State::hold;
  std::optional<double> position, velocity, effort;
};

/// What a sensor measures: m/s^2 and rad/s of an IMU, N and N m of a force-torque sensor.
struct SensorValues {
  std::array<double, 3> linear{}, angular{};
};

/// The firmware of a node with joints and sensors. You add how the joints move and what the sensors measure. It keeps
/// the rules of a CPU towards its robot (protocol.md section 9.1; ours): commands that are stale, early, held by a
/// stop, older, unfit or for others are refused and counted; a joint without commands goes to its safe state; a stop is
/// latched, shown and reported to the daemon; samples have numbers, stamps and fixed times; the daemon regularly hears
/// that it is alive.
///
///     limb_ring::JointNode node = limb_ring::JointNode::connect(argc, argv);
///     std::vector<limb_ring::JointNode::Joint> joints(1);
///     node.on_step([&](double dt, const std::vector<limb_ring::JointGoal>& goals) { ...; return joints; });
///     return node.run();
///
/// Not for several threads. An exception of one of your functions ends run(), which passes it on.
class JointNode {
 public:
  /// Position, velocity and effort of a joint.
  using Joint = payload::JointState::Joint;
  /// @param dt s since the last call, 0 or more @param goals of all joints, in order
  /// @return what the joints do now, all of them in order
  using Step = std::function<std::vector<Joint>(double dt, const std::vector<JointGoal>& goals)>;

  struct Options {
    std::string ring, node;  ///< as ConnectOptions; empty: the environment's, which ringd gives its CPUs
    std::string runtime;     ///< as ConnectOptions
    /// Also steps at the instant when a goal changes between two samples: for simulations. False: one step per sample.
    bool at_once = false;
    /// Called about every 50 ms while others, such as a paused ring, keep this node waiting. What it throws ends the
    /// wait.
    std::function<void()> meanwhile;
  };

  /// @throw HostPortError if the daemon is not there, does not answer, or has another CPU
  static JointNode connect(const Options& options);
  /// With the arguments `PROGRAM [RING NODE]`; without RING and NODE, from the environment that ringd gives its CPU.
  /// Further arguments, such as those that roslaunch adds, are ignored.
  /// @throw HostPortError; std::invalid_argument with the usage, if there is only one argument
  static JointNode connect(int argc, const char* const* argv);
  JointNode(JointNode&&) noexcept;
  JointNode& operator=(JointNode&&) noexcept;
  ~JointNode();

  const NodeSetup& setup() const;
  /// For packets of your own. Its receive() is this class's.
  HostPort& port();
  /// What the joints did last, as Step returned it; at first they stand at `initial`.
  const std::vector<Joint>& joints() const;

  /// Moves the joints: once before each sample of their state, at setup().state_rate.
  void on_step(Step step);
  /// Measures. @throw std::invalid_argument if no sensor of this node has that name; it names those that it has
  void on_sensor(const std::string& name, std::function<SensorValues()> measure);
  /// A packet that is not joint data. @return true: it is for this CPU; false: it is counted as ignored
  void on_packet(std::function<bool(const Packet&)> take);
  /// A pin with the action `notify` was pulled.
  void on_notify(std::function<void(const Interrupt&)> take);
  /// A command was obeyed.
  void on_command(std::function<void(const payload::JointCommand&)> take);
  /// In each turn, at least every 100 ms: to check whether to end(), such as after a signal.
  void meanwhile(std::function<void()> call);
  /// Once, at that time of the ring's clock (port().now()).
  void at(std::chrono::nanoseconds time, std::function<void()> call);

  /// Runs until end() or until the daemon is gone. @return what end() was given; 1 if the daemon is gone
  /// @throw std::logic_error if Step is missing or returns another number of joints, or values that are not numbers
  int run();
  /// Makes run() return `code`.
  void end(int code);
  /// Counts of what was sent, obeyed and refused, in one line for people.
  std::string summary() const;

 private:
  struct Impl;
  explicit JointNode(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limb_ring
