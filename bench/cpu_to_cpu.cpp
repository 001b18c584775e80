#include "bench/cpu_to_cpu.h"

#include <atomic>
#include <exception>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <thread>

#include "bench/cores.h"
#include "bench/measurement.h"
#include "bench/private_ring.h"
#include "bench/setup.h"

namespace limb_ring::bench {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestLap{1000};

struct EchoOutcome {
  std::atomic<bool> echo_ready{false}, done{false};
  Measurement measured;
};

std::size_t across(const PrivateRing& ring) { return ring.config().nodes.size() / 2; }

/// The next packet for this CPU, past results. @return nothing where none comes in time
std::optional<Packet> next_packet(HostPort& port) {
  const auto deadline = Samples::Clock::now() + kLongestLap;
  while (port.connected() && Samples::Clock::now() < deadline) {
    auto message = port.receive(kLongestLap);
    if (!message) continue;
    if (auto* packet = std::get_if<Packet>(&*message)) return std::move(*packet);
  }
  return {};
}

void echo(HostPort port, std::atomic<bool>& ready) {
  ready = true;
  while (port.connected())
    if (const auto packet = next_packet(port)) port.send(packet->source, packet->data);
}

void measure(HostPort port, std::uint8_t to, const Setup& setup, EchoOutcome& outcome) {
  const std::vector<std::uint8_t> data(setup.payload);
  Samples samples(setup.round_seconds());
  std::uint64_t failed = 0;
  samples.begin(Samples::Clock::now());
  bool go_on = true;
  while (go_on && failed < 10) {
    port.send(to, data);
    if (next_packet(port))
      go_on = samples.lap(Samples::Clock::now());
    else
      ++failed;
  }
  outcome.measured = samples.measurement();
  outcome.measured.failed = failed;
  outcome.done = true;
}

void require(bool talks) {
  if (!talks) throw std::runtime_error("two CPUs could not talk over the ring");
}

}  // namespace

std::string write_two_cpus(const Setup& setup, const live::PrivateFolder& folder) {
  return write_ring(folder.path() + "/two_cpus.yaml", setup.nodes, "", {0, setup.nodes / 2});
}

Measurement measure_cpu_to_cpu(const Setup& setup, const PrivateRing& ring, Pinning pinning) {
  const auto cores = cores_for(pinning);
  Shared<EchoOutcome> outcome(1);
  Worker echoes([&] {
    stay_on(cores);
    echo(ring.connect(across(ring), Role::cpu), outcome[0].echo_ready);
  });
  require(echoes.sets(outcome[0].echo_ready, setup.poll, kPatience));
  Worker sender([&] {
    stay_on(cores);
    measure(ring.connect(0, Role::cpu), ring.config().nodes[across(ring)].id, setup, outcome[0]);
  });
  require(sender.sets(outcome[0].done, setup.poll, kPatience + setup.case_time()));
  return outcome[0].measured;
}

namespace {

/// @return exit code
int run(const std::function<void()>& work) {
  try {
    work();
    return 0;
  } catch (const std::exception& problem) {
    std::cerr << "benchmark: " << problem.what() << std::endl;
    return 1;
  }
}

}  // namespace

Worker::Worker(const std::function<void()>& work)
    : child_(std::make_unique<process::Child>(process::spawn_copy([&] { return run(work); }), "worker")) {
  if (child_->ended()) throw std::runtime_error(child_->ended()->text);
}

Worker::~Worker() {
  if (child_) child_->kill();
}

bool Worker::running() {
  child_->reap();
  return !child_->ended();
}

bool Worker::sets(const std::atomic<bool>& flag, const std::function<void()>& poll,
                  std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (; !flag; std::this_thread::sleep_for(kTick)) {
    poll();
    if (!running() || std::chrono::steady_clock::now() > deadline) return flag;
  }
  return true;
}

}  // namespace limb_ring::bench
