#include "bench/own_rate.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "bench/cpu_share.h"
#include "bench/private_ring.h"
#include "bench/ros_programs.h"

namespace limb_ring::bench {
namespace {

constexpr const char* kOwnRateEnds = "own_rate_ends";
constexpr const char* kOwnRate = "1000";

void replace(std::string& text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  if (at == std::string::npos) throw std::runtime_error("humanoid16.yaml has no '" + before + "' any more");
  text.replace(at, before.size(), after);
}

/// The humanoid as it is, but for its rates.
std::string write_fast_humanoid(const Setup& setup, const live::PrivateFolder& folder) {
  std::ostringstream text;
  text << std::ifstream(setup.humanoid).rdbuf();
  std::string ring = text.str();
  replace(ring, "state_rate: 100 ", std::string("state_rate: ") + kOwnRate + " ");
  replace(ring, "bridge:\n  rate: 50", std::string("bridge:\n  rate: ") + kOwnRate);
  const std::string path = folder.path() + "/own_rate.yaml";
  std::ofstream(path) << ring;
  return path;
}

}  // namespace

OwnRateResult measure_own_rate(const Setup& setup, const live::PrivateFolder& folder) {
  OwnRateResult result;
  result.skipped = setup.humanoid.empty() ? "no humanoid16.yaml" : RosPrograms::missing(setup, kOwnRateEnds);
  if (!result.skipped.empty()) return result;
  setup.tell(std::string("humanoid at ") + kOwnRate + " Hz");
  const std::string config = write_fast_humanoid(setup, folder);
  PrivateRing ring(setup, {config, "", Pinning::free});
  RosPrograms programs(setup, folder);
  process::Program& bridge = programs.start("ring_bridge", {"_config:=" + config, "_ring:=" + ring.name()});
  process::Program& ends = programs.start(kOwnRateEnds, {kOwnRate, std::to_string(setup.seconds)});
  std::vector<pid_t> processes = ring.processes();
  processes.push_back(bridge.pid());
  const CpuShare share(processes);
  const auto said = programs.result_of(ends);
  result.measured = {said.at("joint_states_rate"), said.at("samples"),    said.at("left_out"),
                     said.at("lap_p50_us"),        said.at("lap_p99_us"), share.percent()};
  return result;
}

}  // namespace limb_ring::bench
