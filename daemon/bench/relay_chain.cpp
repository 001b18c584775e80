#include "bench/relay_chain.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/cores.h"
#include "process/find_program.h"
#include "process/program.h"
#include "process/unique_fd.h"

namespace limb_ring::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kChainTick{50};
constexpr milliseconds kChainPatience{60'000};

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

std::string link_name(unsigned index) { return "/chain/" + std::to_string(index); }

/// The processes of a chain; they end with it.
class Chain {
 public:
  Chain(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning)
      : setup_(setup), folder_(folder), pinning_(pinning), port_(free_port()) {}

  ~Chain() {
    for (const process::Program& program : programs_) program.signal(SIGTERM);
    for (process::Program& program : programs_) program.end();
  }

  Measurement run() {
    start("rosmaster", {"--core", "-p", port_}, {});
    for (unsigned i = 0; i < setup_.nodes; ++i)
      start(find_relay(), {link_name(i), link_name(i + 1), "__name:=relay" + std::to_string(i)}, cores_for(pinning_));
    start("relay_chain_ends",
          {link_name(0), link_name(setup_.nodes), std::to_string(setup_.payload), std::to_string(setup_.seconds)},
          cores_for(pinning_));
    wait_for_end(programs_.back());
    return measurement_of(programs_.back());
  }

 private:
  void start(const std::string& program, const std::vector<std::string>& arguments,
             const std::optional<cpu_set_t>& cores) {
    const std::string log = folder_.path() + "/chain" + std::to_string(programs_.size()) + ".log";
    programs_.emplace_back(process::ProgramRequest{
        program,
        arguments,
        {{"ROS_MASTER_URI", "http://127.0.0.1:" + port_}, {"ROS_IP", "127.0.0.1"}, {"ROS_LOG_DIR", folder_.path()}},
        log,
        process::Lifetime::asked_to_end,
        cores});
  }

  void wait_for_end(process::Program& ends) {
    const auto deadline = steady_clock::now() + kChainPatience;
    while (ends.reap(), !ends.ended()) {
      setup_.poll();
      if (steady_clock::now() > deadline) throw std::runtime_error("it did not get going within a minute");
      std::this_thread::sleep_for(kChainTick);
    }
  }

  static Measurement measurement_of(const process::Program& ends) {
    const std::string said = ends.output();
    const std::size_t at = said.find('{');
    const auto json = nlohmann::json::parse(at == std::string::npos ? "" : said.substr(at), nullptr, false);
    if (!json.is_object()) throw std::runtime_error(ends.last_lines());
    Measurement measured;
    measured.round_trip_us = {json.at("p50"), json.at("p99"), json.at("max")};
    measured.packets_per_second = json.at("packets_per_second");
    measured.packets = json.at("packets");
    return measured;
  }

  const Setup& setup_;
  const live::PrivateFolder& folder_;
  Pinning pinning_;
  std::string port_;
  std::vector<process::Program> programs_;
};

std::string missing(const Setup& setup) {
  if (!setup.ros) return "--no-ros";
  if (process::find_program("relay_chain_ends").empty()) return "built without ROS (no relay_chain_ends)";
  if (process::find_program("rosmaster").empty()) return "no rosmaster on PATH";
  if (find_relay().empty()) return "topic_tools is not installed";
  return {};
}

}  // namespace

RelayChainResult measure_relay_chain(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning) {
  RelayChainResult result;
  result.skipped = missing(setup);
  if (!result.skipped.empty()) return result;
  result.measured = Chain(setup, folder, pinning).run();
  return result;
}

}  // namespace limb_ring::bench
