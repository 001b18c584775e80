#include "bench/own_rate.h"

#include "bench/cpu_share.h"
#include "bench/humanoid.h"
#include "bench/private_ring.h"
#include "bench/ros_programs.h"

namespace limb_ring::bench {
namespace {

constexpr const char* kOwnRateEnds = "own_rate_ends";
constexpr unsigned kOwnRate = 1000;

}  // namespace

OwnRateResult measure_own_rate(const Setup& setup, const live::PrivateFolder& folder) {
  OwnRateResult result;
  result.skipped = setup.humanoid.empty() ? "no humanoid16.yaml" : RosPrograms::missing(setup, kOwnRateEnds);
  if (!result.skipped.empty()) return result;
  const std::string rate = std::to_string(kOwnRate);
  setup.tell("humanoid at " + rate + " Hz");
  const std::string config = write_humanoid(setup, folder, kOwnRate, "rate: " + rate);
  PrivateRing ring(setup, {config, "", Pinning::free});
  RosPrograms programs(setup, folder);
  process::Program& bridge = programs.start("ring_bridge", {"_config:=" + config, "_ring:=" + ring.name()});
  process::Program& ends = programs.start(kOwnRateEnds, {rate, std::to_string(setup.seconds)});
  std::vector<pid_t> processes = ring.processes();
  processes.push_back(bridge.pid());
  const CpuShare share(processes);
  const auto said = programs.result_of(ends);
  result.measured = {said.at("joint_states_rate"), said.at("commands_rate"), said.at("samples"), said.at("left_out"),
                     said.at("lap_p50_us"),        said.at("lap_p99_us"),    share.percent()};
  return result;
}

}  // namespace limb_ring::bench
