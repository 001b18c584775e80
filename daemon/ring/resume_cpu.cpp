#include "ring/resume_cpu.h"

#include "limb_ring/payload/packet_type.h"

namespace limb_ring::ask {
namespace {

constexpr std::chrono::microseconds kValidFor = std::chrono::seconds(1);
constexpr std::uint8_t kPriority = 0;

}  // namespace

payload::JointCommand resume_command(std::int64_t stamp_ns) {
  payload::JointCommand command;
  command.resume = true;
  command.stamp_ns = stamp_ns;
  command.valid_for_us = static_cast<std::uint32_t>(kValidFor.count());
  return command;
}

Result resume_cpu(HostPort& port, std::uint8_t node, std::chrono::milliseconds timeout) {
  const auto bytes = payload::encode(resume_command(port.stamp().count()));  // cannot fail: it names no joints
  return port.wait(port.send(node, *bytes, kPriority, payload::kJointChannel), timeout);
}

}  // namespace limb_ring::ask
