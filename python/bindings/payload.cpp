// The formats inside packets: limb_ring/payload. What cannot be written or read is a ValueError that says why.
#include <chrono>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "bindings.h"
#include "limb_ring/payload/announcement.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/fragmenter.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/packet_type.h"
#include "limb_ring/payload/reassembler.h"
#include "limb_ring/payload/sensor_reading.h"

namespace limb_ring::python {
namespace {

using namespace payload;
using std::optional;

constexpr const char* kDecodes = "From the bytes of a packet. ValueError if they cannot be read, with the reason";

/// A payload that knows whether somebody has given it a stamp. If nobody has, HostPort.send() does: the ring's clock
/// may be a virtual one.
template <typename T>
struct Stamped : T {
  bool stamp_given = true;
};

template <typename T>
py::bytes encoded(const T& value) {
  const auto bytes = encode(value);
  if (!bytes) throw py::value_error(to_string(bytes.error()));
  return to_bytes(*bytes);
}

template <typename T>
T decoded(const Decoded<T>& value) {
  if (!value) throw py::value_error(to_string(value.error()));
  return *value;
}

template <typename T>
Stamped<T> stamped(T value, optional<std::int64_t> stamp_ns) {
  const std::chrono::nanoseconds now = std::chrono::system_clock::now().time_since_epoch();
  value.stamp_ns = stamp_ns.value_or(now.count());
  return {std::move(value), stamp_ns.has_value()};
}

/// Their stamp, and what depends on it.
template <typename T, typename Decode>
void bind_stamped(py::class_<Stamped<T>>& type, const char* when, Decode decode) {
  const std::string says =
      std::string("CLOCK_REALTIME when ") + when + "; default: when it is sent, by the ring's clock";
  type.def_property(
          "stamp_ns", [](const Stamped<T>& value) { return value.stamp_ns; },
          [](Stamped<T>& value, std::int64_t stamp_ns) {
            value.stamp_ns = stamp_ns;
            value.stamp_given = true;
          },
          says.c_str())
      .def_readonly("stamp_given", &Stamped<T>::stamp_given, "false: the default")
      .def(
          "encode",
          [](const Stamped<T>& value, optional<std::int64_t> now_ns) {
            T sent = value;
            if (now_ns && !value.stamp_given) sent.stamp_ns = *now_ns;
            return encoded(sent);
          },
          py::arg("now_ns") = py::none(), "bytes. now_ns: the stamp where none was given")
      .def_static(
          "decode",
          [decode](const std::string& bytes) {
            return Stamped<T>{decoded(decode(view(bytes))), true};
          },
          py::arg("packet"), kDecodes);
}

std::string joints_text(std::size_t count) { return std::to_string(count) + (count == 1 ? " joint" : " joints"); }

/// "0.5 rad, -1 rad/s"; what is None is left out.
std::string joint_text(optional<double> position, optional<double> velocity, optional<double> effort) {
  std::ostringstream text;
  const char* between = "";
  const auto add = [&](optional<double> value, const char* unit) {
    if (value) text << std::exchange(between, ", ") << *value << unit;
  };
  add(position, " rad");
  add(velocity, " rad/s");
  add(effort, " N m");
  return text.str();
}

std::string mode_text(const JointState::Mode& mode) {
  const std::string words = payload::to_string(mode);
  return words.empty() ? words : ", " + words;
}

void bind_joint_state(py::module& module) {
  using State = Stamped<JointState>;
  py::class_<State> state(module, "JointState", "What a node's joints do, from its CPU to the body, on channel 2");
  py::class_<State::Mode>(state, "Mode", "What the joints of the node are about")
      .def(py::init<>())
      .def_readwrite("commanded", &State::Mode::commanded, "at least one joint obeys a command")
      .def_readwrite("safe", &State::Mode::safe, "at least one joint is in its safe state")
      .def_readwrite("hold", &State::Mode::hold, "... and holds its position")
      .def_readwrite("damp", &State::Mode::damp, "... and lets its velocity decay")
      .def_readwrite("stopped", &State::Mode::stopped, "by an emergency stop, until a command resumes it")
      .def_readwrite("command_refused", &State::Mode::command_refused, "a command was refused since the last state")
      .def_readwrite("saturated", &State::Mode::saturated, "a value was out of range and cut to it");
  py::class_<State::Joint>(state, "Joint")
      .def(py::init([](double position, double velocity, double effort) {
             return State::Joint{position, velocity, effort};
           }),
           py::arg("position") = 0.0, py::arg("velocity") = 0.0, py::arg("effort") = 0.0)
      .def_readwrite("position", &State::Joint::position, "rad")
      .def_readwrite("velocity", &State::Joint::velocity, "rad/s")
      .def_readwrite("effort", &State::Joint::effort, "N m")
      .def("__repr__",
           [](const State::Joint& j) { return "<Joint " + joint_text(j.position, j.velocity, j.effort) + ">"; });
  state
      .def(py::init([](std::vector<State::Joint> joints, std::uint16_t sequence, optional<std::int64_t> stamp_ns) {
             JointState value;
             value.joints = std::move(joints);
             value.sequence = sequence;
             return stamped(std::move(value), stamp_ns);
           }),
           py::arg("joints") = std::vector<State::Joint>{}, py::arg("sequence") = 0, py::arg("stamp_ns") = py::none())
      .def_readwrite("sequence", &State::sequence)
      .def_readwrite("mode", &State::mode)
      .def_readwrite("refused", &State::refused, "commands refused since the CPU's start")
      .def_readwrite("joints", &State::joints, "in the order of the YAML; assign a list, do not append")
      .def("__repr__", [](const State& s) {
        return "<JointState " + std::to_string(s.sequence) + ": " + joints_text(s.joints.size()) + mode_text(s.mode) +
               ">";
      });
  bind_stamped<JointState>(state, "sampled", decode_joint_state);
}

std::uint32_t valid_for_us(double seconds) {
  if (!(seconds >= 0 && seconds <= 4294)) throw py::value_error("valid_for: 0 to 4294 s are possible");
  return static_cast<std::uint32_t>(std::llround(seconds * 1e6));
}

void bind_joint_command(py::module& module) {
  using Command = Stamped<JointCommand>;
  py::class_<Command> command(module, "JointCommand", "What a node's joints shall do, to its CPU, on channel 2");
  py::class_<Command::Joint>(command, "Joint", "None: not commanded")
      .def(py::init([](optional<double> position, optional<double> velocity, optional<double> effort) {
             return Command::Joint{position, velocity, effort};
           }),
           py::arg("position") = py::none(), py::arg("velocity") = py::none(), py::arg("effort") = py::none())
      .def_readwrite("position", &Command::Joint::position, "rad")
      .def_readwrite("velocity", &Command::Joint::velocity, "rad/s")
      .def_readwrite("effort", &Command::Joint::effort, "N m")
      .def("__repr__",
           [](const Command::Joint& j) { return "<Joint " + joint_text(j.position, j.velocity, j.effort) + ">"; });
  command
      .def(py::init([](std::vector<Command::Joint> joints, double valid_for, bool resume, std::uint16_t sequence,
                       optional<std::int64_t> stamp_ns) {
             JointCommand value;
             value.joints = std::move(joints);
             value.valid_for_us = valid_for_us(valid_for);
             value.resume = resume;
             value.sequence = sequence;
             return stamped(std::move(value), stamp_ns);
           }),
           py::arg("joints") = std::vector<Command::Joint>{}, py::arg("valid_for") = 0.1, py::arg("resume") = false,
           py::arg("sequence") = 0, py::arg("stamp_ns") = py::none())
      .def_readwrite("sequence", &Command::sequence)
      .def_readwrite("valid_for_us", &Command::valid_for_us)
      .def_readwrite("resume", &Command::resume, "ends a latched stop")
      .def_readonly("saturated", &Command::saturated)
      .def_readwrite("joints", &Command::joints, "in the order of the YAML; assign a list, do not append")
      .def("__repr__", [](const Command& c) {
        const double valid_for = seconds(std::chrono::microseconds(c.valid_for_us));
        return py::str("<JointCommand {}: {}, valid for {} s{}>")
            .format(c.sequence, joints_text(c.joints.size()), valid_for, c.resume ? ", resume" : "");
      });
  bind_stamped<JointCommand>(command, "commanded", decode_joint_command);
}

void bind_command_set(py::module& module) {
  using Set = Stamped<CommandSet>;
  using Parts = std::map<std::uint8_t, std::vector<JointCommand::Joint>>;
  py::class_<Set> set(module, "CommandSet",
                      "What the joints of several nodes shall do, to all CPUs in one broadcast, on channel 2");
  set.def(py::init([](const Parts& parts, double valid_for, std::uint16_t sequence, optional<std::int64_t> stamp_ns) {
            CommandSet value;
            for (const auto& [node, joints] : parts) value.parts.push_back({node, joints});
            value.valid_for_us = valid_for_us(valid_for);
            value.sequence = sequence;
            return stamped(std::move(value), stamp_ns);
          }),
          py::arg("parts"), py::arg("valid_for") = 0.1, py::arg("sequence") = 0, py::arg("stamp_ns") = py::none(),
          "parts: by a node's id its joints, each a JointCommand.Joint, in the order of the YAML")
      .def_readwrite("sequence", &Set::sequence)
      .def_readwrite("valid_for_us", &Set::valid_for_us)
      .def_readonly("saturated", &Set::saturated)
      .def_property_readonly("parts",
                             [](const Set& c) {
                               Parts parts;
                               for (const auto& part : c.parts) parts[part.node] = part.joints;
                               return parts;
                             })
      .def(
          "to",
          [](const Set& c, std::uint8_t node) -> optional<Stamped<JointCommand>> {
            auto command = c.CommandSet::to(node);
            if (!command) return std::nullopt;
            return Stamped<JointCommand>{std::move(*command), c.stamp_given};
          },
          py::arg("node"), "The JointCommand for the node of that id; None where it has no part")
      .def("__repr__", [](const Set& c) {
        const double valid_for = seconds(std::chrono::microseconds(c.valid_for_us));
        return py::str("<CommandSet {}: {} nodes, valid for {} s>").format(c.sequence, c.parts.size(), valid_for);
      });
  bind_stamped<CommandSet>(set, "commanded", decode_command_set);
}

void bind_sensor_reading(py::module& module) {
  using Reading = Stamped<SensorReading>;
  py::class_<Reading> reading(module, "SensorReading",
                              "One sample of an IMU or a force and torque sensor, on channel 2");
  reading
      .def(py::init([](const std::string& kind, std::array<double, 3> linear, std::array<double, 3> angular,
                       std::uint8_t sensor, std::uint16_t sequence, optional<std::int64_t> stamp_ns) {
             if (kind != "imu" && kind != "force") throw py::value_error("kind: 'imu' or 'force', not '" + kind + "'");
             SensorReading value;
             value.kind = kind == "imu" ? Reading::Kind::imu : Reading::Kind::force;
             value.linear = linear;
             value.angular = angular;
             value.sensor = sensor;
             value.sequence = sequence;
             return stamped(value, stamp_ns);
           }),
           py::arg("kind"), py::arg("linear"), py::arg("angular"), py::arg("sensor") = 0, py::arg("sequence") = 0,
           py::arg("stamp_ns") = py::none())
      .def_property_readonly("kind", [](const Reading& r) { return r.kind == Reading::Kind::imu ? "imu" : "force"; })
      .def_readwrite("sequence", &Reading::sequence)
      .def_readwrite("sensor", &Reading::sensor, "its place among the node's sensors, from 0")
      .def_readonly("saturated", &Reading::saturated)
      .def_readwrite("linear", &Reading::linear, "x, y, z: m/s^2 or N")
      .def_readwrite("angular", &Reading::angular, "x, y, z: rad/s or N m")
      .def("__repr__", [](const Reading& r) {
        const char* kind = r.kind == Reading::Kind::imu ? "imu " : "force ";
        return "<SensorReading " + std::to_string(r.sequence) + ": " + kind + std::to_string(r.sensor) + ">";
      });
  bind_stamped<SensorReading>(reading, "sampled", decode_sensor_reading);
}

void bind_topics(py::module& module) {
  py::class_<Announcement>(module, "Announcement", "What a topic is called and made of, before its first data")
      .def(py::init([](const std::string& name, const std::string& datatype, const std::string& md5sum,
                       const std::string& definition, bool latching) {
             return Announcement{name, datatype, md5sum, definition, latching};
           }),
           py::arg("name"), py::arg("datatype"), py::arg("md5sum"), py::arg("definition"), py::arg("latching") = false)
      .def_readonly("name", &Announcement::name)
      .def_readonly("datatype", &Announcement::datatype)
      .def_readonly("md5sum", &Announcement::md5sum)
      .def_readonly("definition", &Announcement::definition)
      .def_readonly("latching", &Announcement::latching)
      .def("encode", &encoded<Announcement>)
      .def_static(
          "decode", [](const std::string& bytes) { return decoded(decode_announcement(view(bytes))); },
          py::arg("packet"), kDecodes);
  py::class_<Fragmenter>(module, "Fragmenter", "Cuts messages of one topic into packets for channel 3")
      .def(py::init<std::uint8_t>(), py::arg("topic"))
      .def(
          "packets",
          [](Fragmenter& fragmenter, const std::string& message, bool announcement) {
            const auto kind = announcement ? Fragment::Kind::announcement : Fragment::Kind::data;
            if (!fragmenter.start(kind, {message.begin(), message.end()}))
              throw py::value_error("a message has at most " + std::to_string(kMaxMessage) + " bytes");
            py::list packets;
            while (!fragmenter.done()) packets.append(to_bytes(fragmenter.next()));
            return packets;
          },
          py::arg("message"), py::arg("announcement") = false, "the packets of the next message, each as bytes");
  py::class_<Reassembler>(module, "Reassembler", "Puts fragments together again")
      .def(py::init<>())
      .def(
          "take",
          [](Reassembler& reassembler, std::uint8_t source, const std::string& packet) -> py::object {
            const auto message = reassembler.take(source, view(packet));
            if (!message || message->kind != Fragment::Kind::data) return py::none();
            return py::make_tuple(message->topic, to_bytes(message->bytes));
          },
          py::arg("source"), py::arg("packet"), "(topic, bytes) where the packet completes a message of data")
      .def(
          "announcement",
          [](const Reassembler& reassembler, std::uint8_t source, std::uint8_t topic) -> py::object {
            const Announcement* found = reassembler.announcement(source, topic);
            return found != nullptr ? py::cast(*found) : py::none();
          },
          py::arg("source"), py::arg("topic"),
          "The Announcement of that topic of node `source`; None if none has come");
}

}  // namespace

void bind_payload(py::module& module) {
  module.attr("USER_CHANNEL") = kUserChannel;
  module.attr("JOINT_CHANNEL") = kJointChannel;
  module.attr("TOPIC_CHANNEL") = kTopicChannel;
  bind_joint_state(module);
  bind_joint_command(module);
  bind_command_set(module);
  bind_sensor_reading(module);
  bind_topics(module);
}

}  // namespace limb_ring::python
