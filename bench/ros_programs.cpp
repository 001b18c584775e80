#include "bench/ros_programs.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "bench/waits.h"
#include "io/find_program.h"
#include "io/unique_fd.h"

namespace limb_ring::bench {
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
