// JointNode: what Python writes is called with the GIL, everything else runs without it.
#include "limb_ring/joint_node.h"
#include "bindings.h"

namespace limb_ring::python {
namespace {

/// Of a joint a number alone is its position.
JointNode::Joint joint_of(const py::handle& given) {
  if (py::isinstance<JointNode::Joint>(given)) return given.cast<JointNode::Joint>();
  if (PyNumber_Check(given.ptr()) != 0) return {given.cast<double>(), 0, 0};
  const auto values = given.cast<std::vector<double>>();
  if (values.empty() || values.size() > 3)
    throw py::value_error("step(): of each joint its position is needed, or (position, velocity, effort), not " +
                          std::to_string(values.size()) + " values");
  return {values[0], values.size() > 1 ? values[1] : 0, values.size() > 2 ? values[2] : 0};
}

std::vector<JointNode::Joint> joints_of(const py::object& given) {
  if (!py::isinstance<py::sequence>(given))
    throw py::type_error("step() has to return a list with an entry for each joint, not " +
                         py::repr(given).cast<std::string>());
  std::vector<JointNode::Joint> joints;
  for (const py::handle& one : given) joints.push_back(joint_of(one));
  return joints;
}

SensorValues values_of(const py::object& given) {
  const auto [linear, angular] = given.cast<std::pair<std::array<double, 3>, std::array<double, 3>>>();
  return {linear, angular};
}

JointNode connect_joint_node(const std::string& ring, const std::string& node, bool at_once,
                             const std::string& runtime) {
  JointNode::Options options;
  options.ring = ring;
  options.node = node;
  options.at_once = at_once;
  options.runtime = runtime;
  options.meanwhile = [] {
    const py::gil_scoped_acquire look;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  };
  JointNode made = JointNode::connect(options);
  made.meanwhile(options.meanwhile);
  return made;
}

/// A Python function that others call, from where Python is not held.
std::function<void()> called(py::function call) {
  const auto forget = [](py::function* one) {
    const py::gil_scoped_acquire held;
    delete one;
  };
  const std::shared_ptr<py::function> kept(new py::function(std::move(call)), forget);
  return [kept] {
    const py::gil_scoped_acquire held;
    (*kept)();
  };
}

std::string state_word(const JointGoal& goal) {
  switch (goal.state) {
    case JointGoal::State::commanded:
      return "commanded";
    case JointGoal::State::hold:
      return "hold";
    case JointGoal::State::damp:
      return "damp";
  }
  return "";
}

}  // namespace

void bind_joint_node(py::module& module) {
  py::class_<NodeJoint>(module, "NodeJoint")
      .def_readonly("name", &NodeJoint::name)
      .def_readonly("slides", &NodeJoint::slides)
      .def_readonly("lower", &NodeJoint::lower)
      .def_readonly("upper", &NodeJoint::upper)
      .def_readonly("velocity", &NodeJoint::velocity)
      .def_readonly("effort", &NodeJoint::effort)
      .def_readonly("initial", &NodeJoint::initial)
      .def_readonly("damps", &NodeJoint::damps);
  py::class_<NodeSensor>(module, "NodeSensor")
      .def_readonly("name", &NodeSensor::name)
      .def_readonly("imu", &NodeSensor::imu)
      .def_readonly("rate", &NodeSensor::rate)
      .def_readonly("topic", &NodeSensor::topic);
  py::class_<JointGoal>(module, "JointGoal")
      .def_property_readonly("state", &state_word)
      .def_readonly("position", &JointGoal::position)
      .def_readonly("velocity", &JointGoal::velocity)
      .def_readonly("effort", &JointGoal::effort);
  using Released = py::call_guard<py::gil_scoped_release>;
  py::class_<JointNode>(module, "JointNode")
      .def(py::init(&connect_joint_node), py::arg("ring"), py::arg("node"), py::arg("at_once"), py::arg("runtime"),
           Released())
      .def_property_readonly("id", [](const JointNode& node) { return node.setup().id; })
      .def_property_readonly("name", [](const JointNode& node) { return node.setup().name; })
      .def_property_readonly("setup_joints", [](const JointNode& node) { return node.setup().joints; })
      .def_property_readonly("setup_sensors", [](const JointNode& node) { return node.setup().sensors; })
      .def_property_readonly("state_rate", [](const JointNode& node) { return node.setup().state_rate; })
      .def("now_ns", [](JointNode& node) { return node.port().now().count(); })
      .def("send",
           [](JointNode& node, std::uint8_t to, const std::string& data, std::uint8_t priority, std::uint8_t channel) {
             return node.port().send(to, view(data).data, data.size(), priority, channel);
           })
      .def("on_step",
           [](JointNode& node, const py::function& step) {
             node.on_step([step](double dt, const std::vector<JointGoal>& goals) {
               const py::gil_scoped_acquire held;
               return joints_of(step(dt, goals));
             });
           })
      .def("on_sensor",
           [](JointNode& node, const std::string& name, const py::function& measure) {
             node.on_sensor(name, [measure] {
               const py::gil_scoped_acquire held;
               return values_of(measure());
             });
           })
      .def("on_packet",
           [](JointNode& node, const py::function& take) {
             node.on_packet([take](const Packet& packet) {
               const py::gil_scoped_acquire held;
               return py::cast<bool>(py::bool_(take(packet)));
             });
           })
      .def("on_notify",
           [](JointNode& node, const py::function& take) {
             node.on_notify([take](const Interrupt& interrupt) {
               const py::gil_scoped_acquire held;
               take(interrupt);
             });
           })
      .def("at", [](JointNode& node, std::int64_t time_ns,
                    py::function call) { node.at(std::chrono::nanoseconds(time_ns), called(std::move(call))); })
      .def("run", &JointNode::run, Released())
      .def("end", &JointNode::end)
      .def("summary", &JointNode::summary);
}

}  // namespace limb_ring::python
