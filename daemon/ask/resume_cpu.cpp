#include "ask/resume_cpu.h"

#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/packet_type.h"

namespace limb_ring::ask {
namespace {

constexpr std::uint8_t kPriority = 0;

}  // namespace

Result resume_cpu(HostPort& port, std::uint8_t node, std::chrono::milliseconds timeout) {
  payload::JointCommand command;
  command.resume = true;
  command.stamp_ns = port.stamp().count();
  command.valid_for_us = static_cast<std::uint32_t>(kResumeValidFor.count());
  const auto bytes = payload::encode(command);  // cannot fail: it names no joints
  return port.wait(port.send(node, *bytes, kPriority, payload::kJointChannel), timeout);
}

}  // namespace limb_ring::ask
