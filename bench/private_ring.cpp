#include "bench/private_ring.h"

#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "bench/cores.h"
#include "config/load_ring.h"
#include "config/plain_ring.h"

namespace limb_ring::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kAnswerTime{5000};
constexpr milliseconds kClosingTime{20'000};
constexpr milliseconds kRingTick{20};
constexpr milliseconds kGrace{2000};

/// Never the same twice: UDP ports come from it, and an old ring's may still be taken.
std::string fresh_name() {
  static unsigned count = 0;
  return "bench-" + std::to_string(::getpid()) + "-" + std::to_string(++count);
}

config::RingConfig configure(const Setup& setup, const RingRequest& request) {
  const std::string name = fresh_name();
  config::RingConfig ring =
      request.config.empty() ? config::plain_ring(name, setup.nodes) : config::load_ring(request.config);
  config::rename_ring(ring, name);
  return ring;
}

live::LaunchRequest launch_of(const config::RingConfig& ring, const RingRequest& request) {
  std::vector<std::string> arguments = {"--nodes", std::to_string(ring.nodes.size()), "--ring", ring.ring};
  if (!request.config.empty()) arguments.insert(arguments.end(), {"--config", request.config});
  if (!request.transport.empty()) arguments.insert(arguments.end(), {"--transport", request.transport});
  if (request.record) arguments.push_back("--record");
  live::LaunchRequest launch;
  launch.ring = ring.ring;
  launch.cores = cores_for(request.pinning);
  for (const config::NodeConfig& node : ring.nodes) {
    launch.nodes.push_back({wire::NodeId{node.id}, node.name, arguments});
    launch.nodes.back().arguments.insert(launch.nodes.back().arguments.end(), {"--node", std::to_string(node.id)});
  }
  return launch;
}

bool node_is_ready(const nlohmann::json& status, const config::RingConfig& ring, const config::NodeConfig& node) {
  const bool in_ring = status.value("state", "") == "up" && status.value("ring_size", 0u) == ring.nodes.size();
  if (node.cpu.kind != config::CpuConfig::Kind::child) return in_ring;
  return in_ring && status.at("cpu").value("state", "") == "running";
}

}  // namespace

nlohmann::json ask(HostPort& port, const nlohmann::json& request) {
  return nlohmann::json::parse(port.ask(request.dump(), kAnswerTime));
}

PrivateRing::PrivateRing(const Setup& setup, const RingRequest& request)
    : config_(configure(setup, request)), daemons_(launch_of(config_, request)) {
  try {
    wait_until_closed(setup);
  } catch (...) {
    end();
    throw;
  }
}

PrivateRing::~PrivateRing() { end(); }

void PrivateRing::end() {
  const auto wait = [](milliseconds time) {
    std::this_thread::sleep_for(time);
    return false;
  };
  daemons_.end(wait, kGrace);
}

void PrivateRing::require_running() {
  daemons_.reap();
  if (const auto* ended = daemons_.first_ended()) throw std::runtime_error(ended->exit_reason());
}

bool PrivateRing::closed() {
  for (std::size_t i = 0; i < config_.nodes.size(); ++i) {
    try {
      HostPort port = connect(i);
      if (!node_is_ready(ask(port, {{"do", "status"}}), config_, config_.nodes[i])) return false;
    } catch (const HostPortError&) {
      return false;  // not there yet
    }
  }
  return true;
}

void PrivateRing::wait_until_closed(const Setup& setup) {
  const auto deadline = steady_clock::now() + kClosingTime;
  while (!closed()) {
    setup.poll();
    require_running();
    if (steady_clock::now() > deadline)
      throw std::runtime_error("a ring of " + std::to_string(config_.nodes.size()) + " nodes did not close within " +
                               std::to_string(kClosingTime.count() / 1000) + " s" + daemons_.all()[0].last_lines());
    std::this_thread::sleep_for(kRingTick);
  }
}

HostPort PrivateRing::connect(std::size_t index, Role role) const {
  ConnectOptions options;
  options.ring = config_.ring;
  options.node = std::to_string(config_.nodes[index].id);
  options.role = role;
  options.timeout = milliseconds(0);
  return HostPort::connect(options);
}

std::vector<pid_t> PrivateRing::processes() {
  std::vector<pid_t> all;
  for (std::size_t i = 0; i < daemons_.all().size(); ++i) {
    all.push_back(daemons_.all()[i].program.pid());
    HostPort port = connect(i);
    const nlohmann::json cpu = ask(port, {{"do", "status"}}).at("cpu");
    if (cpu.value("kind", "") == "child") all.push_back(cpu.at("pid").get<pid_t>());
  }
  return all;
}

}  // namespace limb_ring::bench
