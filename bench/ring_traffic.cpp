#include "bench/ring_traffic.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <exception>
#include <fstream>
#include <iostream>
#include <optional>
#include <regex>
#include <stdexcept>
#include <thread>

#include "bench/measurement.h"
#include "bench/private_ring.h"
#include "bench/setup.h"
#include "io/program.h"
#include "io/spawn.h"
#include "ring/observed_daemon.h"
#include "wire/pcapng.h"

namespace limb_ring::bench {
namespace {

using std::chrono::steady_clock;

nlohmann::json request_of(const Setup& setup, const config::RingConfig& ring, std::size_t sender) {
  const std::size_t across = (sender + ring.nodes.size() / 2) % ring.nodes.size();
  return {{"do", "ping"},
          {"to", ring.nodes[across].id},
          {"size", setup.payload},
          {"duration_ms", static_cast<std::int64_t>(setup.round_seconds() * 1000) + 1}};
}

nlohmann::json reply_to(std::uint32_t token, HostPort& port, const Setup& setup, steady_clock::time_point deadline) {
  while (steady_clock::now() < deadline) {
    setup.poll();
    const auto message = port.receive(kSlice);
    if (!message) continue;
    if (const auto* reply = std::get_if<Reply>(&*message))
      if (reply->token == token) return nlohmann::json::parse(reply->json);
    if (const auto* gone = std::get_if<Disconnected>(&*message))
      throw std::runtime_error("a ringd has left during the benchmark: " + gone->reason);
  }
  throw std::runtime_error("a ringd did not say in time how its packets fared");
}

Measurement measurement_of(const nlohmann::json& report) {
  if (report.contains("error")) throw std::runtime_error(report.at("error").get<std::string>());
  Measurement measured;
  measured.packets = report.at("delivered").get<std::uint64_t>();
  measured.failed = report.at("sent").get<std::uint64_t>() - measured.packets;
  if (measured.packets == 0) throw std::runtime_error("no packet came back: " + report.dump());
  const auto& times = report.at("round_trip_us");
  measured.round_trip_us = {times.at("p50"), times.at("p99"), times.at("max")};
  measured.packets_per_second = report.at("packets_per_second");
  return measured;
}

}  // namespace

Measurement measure_traffic(const Setup& setup, const PrivateRing& ring, Sending sending) {
  const std::size_t senders = sending == Sending::one ? 1 : ring.config().nodes.size();
  std::vector<HostPort> ports;
  for (std::size_t i = 0; i < senders; ++i) ports.push_back(ring.connect(i));
  std::vector<std::uint32_t> tokens;
  for (std::size_t i = 0; i < senders; ++i)
    tokens.push_back(ports[i].request(request_of(setup, ring.config(), i).dump()));
  const auto deadline = steady_clock::now() + kPatience + setup.case_time();
  std::vector<Measurement> measured;
  for (std::size_t i = 0; i < senders; ++i)
    measured.push_back(measurement_of(reply_to(tokens[i], ports[i], setup, deadline)));
  return together(measured);
}

RingJudge::RingJudge(const Setup& setup, const PrivateRing& ring, Pinning pinning)
    : seen_(std::make_unique<Shared<Seen>>(1)) {
  Seen& seen = (*seen_)[0];
  worker_ = std::make_unique<Worker>([&] {
    stay_on(cores_for(pinning));
    live::PromiseWatch watch({ring.name(), ring.config().node_ids()},
                             [&seen](const promises::Breach&) { seen.broken = true; });
    for (;; std::this_thread::sleep_for(live::PromiseWatch::kRound)) {
      watch.poll();
      seen.ready = watch.watched() == ring.config().nodes.size();
    }
  });
  if (!worker_->sets(seen.ready, setup.poll, kPatience))
    throw std::runtime_error("the ring's promises could not be judged");
}

void RingJudge::require_valid() const {
  if ((*seen_)[0].broken) throw std::runtime_error("a promise of the measured ring was found broken");
}

namespace {

/// Starts `ringctl view`, which ends with this process. @return "http://127.0.0.1:PORT/TOKEN/" and its parts
std::smatch start_view(const std::string& ring, const std::optional<cpu_set_t>& cores, std::string& said) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("too many open files");
  const process::UniqueFd from(ends[0]);
  process::UniqueFd into(ends[1]);
  process::SpawnRequest request;
  request.path = process::own_folder() + "/ringctl";
  request.arguments = {"ringctl", "--ring", ring, "view"};
  request.affinity = cores;
  request.output = into.get();
  process::spawn(request);
  into.reset();
  static const std::regex address("http://127.0.0.1:([0-9]+)(/[0-9a-f]+/)\n");
  std::smatch found;
  char part[512];
  while (!std::regex_search(said, found, address)) {
    const ssize_t got = ::read(from.get(), part, sizeof part);
    if (got <= 0) throw std::runtime_error("ringctl view printed no address: " + said);
    said.append(part, static_cast<std::size_t>(got));
  }
  return found;
}

void look(const std::string& ring, const std::optional<cpu_set_t>& cores, std::atomic<bool>& ready) {
  std::string said;
  const std::smatch address = start_view(ring, cores, said);
  boost::asio::ip::tcp::iostream page("127.0.0.1", address.str(1));
  page << "GET " << address[2] << "events HTTP/1.1\r\nHost: 127.0.0.1:" << address[1] << "\r\n\r\n" << std::flush;
  for (std::string line; std::getline(page, line);)
    if (line == "event: status") ready = true;
}

}  // namespace

RingLook::RingLook(const Setup& setup, const PrivateRing& ring, Pinning pinning)
    : seen_(std::make_unique<Shared<Seen>>(1)) {
  Seen& seen = (*seen_)[0];
  worker_ = std::make_unique<Worker>([&] {
    const auto cores = cores_for(pinning);
    stay_on(cores);
    look(ring.name(), cores, seen.ready);
    seen.ended = true;
  });
  if (!worker_->sets(seen.ready, setup.poll, kPatience))
    throw std::runtime_error("the page of ringctl view was told no status");
}

void RingLook::require_valid() const {
  if ((*seen_)[0].ended) throw std::runtime_error("ringctl view has ended during the benchmark");
}

namespace {

void observe(HostPort port, std::atomic<bool>& ready) {
  std::ofstream nowhere("/dev/null");
  capture::PcapngWriter writer(nowhere, {port.ring(), {}});
  port.observe(R"({"packets": {}})");
  while (port.connected()) {
    const auto message = port.receive(std::chrono::seconds(1));
    if (!message) continue;
    if (std::holds_alternative<CaptureCounts>(*message)) ready = true;  // the first: the daemon has begun
    const auto* packet = std::get_if<CapturedPacket>(&*message);
    if (packet == nullptr) continue;
    writer.packet(packet->time_ns, packet->info, {packet->bytes.data(), packet->bytes.size()}, packet->lost_before);
  }
}

}  // namespace

PacketObserver::PacketObserver(const Setup& setup, const PrivateRing& ring, std::size_t index, Pinning pinning)
    : ready_(std::make_unique<Shared<std::atomic<bool>>>(1)) {
  std::atomic<bool>& ready = (*ready_)[0];
  worker_ = std::make_unique<Worker>([&] {
    stay_on(cores_for(pinning));
    observe(ring.connect(index), ready);
  });
  if (!worker_->sets(ready, setup.poll, kPatience))
    throw std::runtime_error("the packets of a node could not be observed");
}

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestLap{1000};

struct EchoOutcome {
  std::atomic<bool> echo_ready{false}, done{false};
  Measurement measured;
};

std::size_t across(const PrivateRing& ring) { return ring.config().nodes.size() / 2; }

/// The next packet for this CPU, past results. @return nothing if none comes in time
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
