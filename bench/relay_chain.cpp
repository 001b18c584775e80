#include "bench/relay_chain.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "bench/cores.h"
#include "bench/ros_programs.h"

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

}  // namespace limb_ring::bench
