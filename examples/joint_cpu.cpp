// joint_cpu.cpp: the firmware of a node: its joints go where they are told, at 2 rad/s
//   joint_cpu [RING NODE]    as a node's `cpu: {command: [/PATH/joint_cpu]}` without: ringd tells it
#include <limb_ring/joint_node.h>

#include <algorithm>
#include <iostream>
#include <stdexcept>

int main(int argc, char** argv) try {
  limb_ring::JointNode node = limb_ring::JointNode::connect(argc, argv);
  node.on_step([&](double dt, const std::vector<limb_ring::JointGoal>& goals) {
    auto joints = node.joints();  // where they are; at first as the ring's file says
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const double step = 2.0 * dt;  // rad
      const double way = goals[i].position ? *goals[i].position - joints[i].position : 0;
      joints[i].velocity = dt > 0 ? std::clamp(way, -step, step) / dt : 0;
      joints[i].position += joints[i].velocity * dt;
    }
    return joints;
  });
  for (const limb_ring::NodeSensor& sensor : node.setup().sensors)  // lies still
    node.on_sensor(sensor.name, [=] { return limb_ring::SensorValues{{0, 0, sensor.imu ? 9.81 : 0}, {}}; });
  return node.run();
} catch (const std::invalid_argument& usage) {
  std::cerr << usage.what() << std::endl;
  return 2;
} catch (const std::exception& problem) {
  std::cerr << "joint_cpu: " << problem.what() << std::endl;
  return 1;
}
