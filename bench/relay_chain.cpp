#include "bench/relay_chain.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "bench/private_ring.h"
#include "bench/setup.h"
#include "bench/system_costs.h"
#include "io/program.h"
#include "io/unique_fd.h"

namespace limb_ring::bench {
namespace {

constexpr const char* kChainEnds = "relay_chain_ends";

/// topic_tools' relay: below one of the ROS prefixes, else below /usr (Debian's own ROS).
std::string find_relay() {
  const char* prefixes = std::getenv("CMAKE_PREFIX_PATH");
  std::string rest = std::string(prefixes == nullptr ? "" : prefixes) + ":/usr:/opt/ros/noetic";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::string prefix = rest.substr(0, end);
    rest.erase(0, end + 1);
    for (const char* folder : {"/lib/topic_tools/relay", "/topic_tools/relay"})
      if (!prefix.empty() && std::filesystem::exists(prefix + folder)) return prefix + folder;
  }
  return {};
}

std::string link_name(unsigned index) { return "/chain/" + std::to_string(index); }

Measurement run_chain(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning) {
  const auto cores = cores_for(pinning);
  RosPrograms programs(setup, folder);
  for (unsigned i = 0; i < setup.nodes; ++i)
    programs.start(find_relay(), {link_name(i), link_name(i + 1), "__name:=relay" + std::to_string(i)}, cores);
  const auto result = programs.result_of(programs.start(
      kChainEnds, {link_name(0), link_name(setup.nodes), std::to_string(setup.payload), std::to_string(setup.seconds)},
      cores));
  Measurement measured;
  measured.round_trip_us = {result.at("p50"), result.at("p99"), result.at("max")};
  measured.packets_per_second = result.at("packets_per_second");
  measured.packets = result.at("packets");
  return measured;
}

}  // namespace

RelayChainResult measure_relay_chain(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning) {
  RelayChainResult result;
  result.skipped = RosPrograms::missing(setup, kChainEnds);
  if (result.skipped.empty() && find_relay().empty()) result.skipped = "topic_tools is not installed";
  if (!result.skipped.empty()) return result;
  result.measured = run_chain(setup, folder, pinning);
  return result;
}

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

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kRosPatience{60'000};

/// A TCP port that nobody listens at just now.
std::string free_port() {
  const process::UniqueFd probe(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ::bind(probe.get(), reinterpret_cast<sockaddr*>(&address), size);
  ::getsockname(probe.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return std::to_string(ntohs(address.sin_port));
}

}  // namespace

RosPrograms::RosPrograms(const Setup& setup, const live::PrivateFolder& folder)
    : setup_(setup), folder_(folder), port_(free_port()) {
  start("rosmaster", {"--core", "-p", port_});
}

RosPrograms::~RosPrograms() {
  for (const process::Program& program : programs_) program.signal(SIGTERM);
  for (process::Program& program : programs_) program.end();
}

process::Program& RosPrograms::start(const std::string& program, const std::vector<std::string>& arguments,
                                     const std::optional<cpu_set_t>& cores) {
  const std::string log = folder_.path() + "/ros" + std::to_string(programs_.size()) + ".log";
  return programs_.emplace_back(process::ProgramRequest{
      program,
      arguments,
      {{"ROS_MASTER_URI", "http://127.0.0.1:" + port_}, {"ROS_IP", "127.0.0.1"}, {"ROS_LOG_DIR", folder_.path()}},
      log,
      process::Lifetime::asked_to_end,
      cores});
}

nlohmann::json RosPrograms::result_of(process::Program& program) {
  const auto deadline = steady_clock::now() + kRosPatience + setup_.case_time();
  while (program.reap(), !program.ended()) {
    setup_.poll();
    if (steady_clock::now() > deadline) throw std::runtime_error("it did not get going within a minute");
    std::this_thread::sleep_for(kTick);
  }
  const std::string said = program.output();
  const std::size_t at = said.find('{');
  auto json = nlohmann::json::parse(at == std::string::npos ? "" : said.substr(at), nullptr, false);
  if (!json.is_object()) throw std::runtime_error(program.last_lines());
  return json;
}

std::string RosPrograms::missing(const Setup& setup, const std::string& own_program) {
  if (!setup.ros) return "--no-ros";
  if (process::find_program(own_program).empty()) return "built without ROS (no " + own_program + ")";
  if (process::find_program("rosmaster").empty()) return "no rosmaster on PATH";
  return {};
}

}  // namespace limb_ring::bench
