#include "bench/private_ring.h"

#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "bench/measurement.h"
#include "bench/ring_traffic.h"
#include "bench/setup.h"
#include "config/load_ring.h"
#include "config/ring_config.h"
#include "io/unique_fd.h"
#include "wire/packet.h"

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

bool node_is_ready(const ask::ToldRow& row, const config::RingConfig& ring) {
  if (!row.said || row.said->state != "up" || row.said->ring_size != ring.nodes.size()) return false;
  return row.said->cpu.kind != "child" || row.said->cpu.state == "running";
}

}  // namespace

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

std::vector<ask::ToldRow> PrivateRing::rows() const {
  std::vector<ask::Node> nodes;
  for (const config::NodeConfig& node : config_.nodes) nodes.push_back({node.id, node.name});
  return ask::RingClient(config_.ring, nodes).status(steady_clock::now() + kAnswerTime);
}

void PrivateRing::wait_until_closed(const Setup& setup) {
  const auto deadline = steady_clock::now() + kClosingTime;
  const auto is_ready = [this](const ask::ToldRow& row) { return node_is_ready(row, config_); };
  for (auto now = rows(); !std::all_of(now.begin(), now.end(), is_ready); now = rows()) {
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
  for (const live::LaunchedDaemon& daemon : daemons_.all()) all.push_back(daemon.program.pid());
  for (const ask::ToldRow& row : rows())
    if (row.said && row.said->cpu.kind == "child" && row.said->cpu.pid) all.push_back(*row.said->cpu.pid);
  return all;
}

namespace {

using process::UniqueFd;

constexpr std::size_t kReadSize = 64 * 1024;

struct ReferenceOutcome {
  std::atomic<bool> done{false};
  Measurement measured;
};

struct Line {
  UniqueFd in, out;
};

std::vector<Line> make_lines(unsigned count) {
  std::vector<Line> lines(count);
  for (Line& line : lines) {
    std::array<int, 2> ends;
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
      throw std::system_error(errno, std::generic_category(), "sockets of the reference ring");
    line.in.reset(ends[0]);
    line.out.reset(ends[1]);
  }
  return lines;
}

void write_all(int fd, const std::uint8_t* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t wrote = ::write(fd, bytes, size);
    if (wrote <= 0) ::_exit(0);  // the next one has ended, so it is over
    bytes += wrote;
    size -= static_cast<std::size_t>(wrote);
  }
}

/// Waits until all have started: otherwise the first lap would include the time that this takes.
void meet(std::atomic<unsigned>& started, unsigned all) {
  ++started;
  while (started < all) std::this_thread::yield();
}

/// One process of the ring.
class ReferenceNode {
 public:
  ReferenceNode(unsigned id, const Setup& setup, ReferenceOutcome& outcome)
      : id_(static_cast<std::uint8_t>(id)),
        packet_size_(setup.payload + wire::kOverhead),
        samples_(setup.round_seconds()),
        outcome_(outcome) {}

  void run(int in, int out, bool sends) {
    if (sends) send_first(out);
    for (;;) {
      const ssize_t got = ::read(in, buffer_.data(), buffer_.size());
      if (got <= 0) return;
      if (sends) look_for_own(static_cast<std::size_t>(got));
      write_all(out, buffer_.data(), static_cast<std::size_t>(got));
    }
  }

 private:
  void send_first(int out) {
    const std::vector<std::uint8_t> packet(packet_size_, id_);
    samples_.begin(Samples::Clock::now());
    write_all(out, packet.data(), packet.size());
  }

  void look_for_own(std::size_t size) {
    std::size_t at = to_next_packet_;
    for (; at < size; at += packet_size_)
      if (buffer_[at] == id_ && !outcome_.done) lap();
    to_next_packet_ = at - size;
  }

  void lap() {
    if (samples_.lap(Samples::Clock::now())) return;
    outcome_.measured = samples_.measurement();
    outcome_.done = true;  // the packet goes on, so that the others measure a full ring
  }

  std::uint8_t id_;
  std::size_t packet_size_;
  std::size_t to_next_packet_ = 0;
  Samples samples_;
  ReferenceOutcome& outcome_;
  std::array<std::uint8_t, kReadSize> buffer_;
};

std::vector<Worker> start(const Setup& setup, Pinning pinning, unsigned senders, Shared<ReferenceOutcome>& outcomes,
                          std::atomic<unsigned>& started) {
  const auto cores = cores_for(pinning);
  const std::vector<Line> lines = make_lines(setup.nodes);
  std::vector<Worker> workers;
  for (unsigned id = 0; id < setup.nodes; ++id) {
    const int in = lines[(id + setup.nodes - 1) % setup.nodes].in.get();
    const int out = lines[id].out.get();
    workers.emplace_back([&setup, &cores, &outcomes, &started, id, senders, in, out] {
      stay_on(cores);
      meet(started, setup.nodes);
      ReferenceNode(id, setup, outcomes[id]).run(in, out, id < senders);
    });
  }
  return workers;
}

void wait_until_done(const Setup& setup, ReferenceOutcome& outcome, Samples::Clock::time_point deadline) {
  while (!outcome.done) {
    setup.poll();
    if (Samples::Clock::now() > deadline)
      throw std::runtime_error("the reference ring does not go round; is the machine overloaded?");
    std::this_thread::sleep_for(kTick);
  }
}

}  // namespace

Measurement measure_reference(const Setup& setup, Pinning pinning, Sending sending) {
  const unsigned senders = sending == Sending::one ? 1 : setup.nodes;
  Shared<ReferenceOutcome> outcomes(setup.nodes);
  Shared<std::atomic<unsigned>> started(1);
  const std::vector<Worker> workers = start(setup, pinning, senders, outcomes, started[0]);
  const auto deadline = Samples::Clock::now() + kPatience + setup.case_time();
  std::vector<Measurement> measured;
  for (unsigned id = 0; id < senders; ++id) {
    wait_until_done(setup, outcomes[id], deadline);
    measured.push_back(outcomes[id].measured);
  }
  return together(measured);
}

std::string write_ring(const std::string& path, unsigned nodes, const std::string& sections,
                       const std::set<unsigned>& attached) {
  std::ofstream file(path);
  file << "ring: bench\n" << sections << "nodes:\n";
  for (unsigned id = 0; id < nodes; ++id) {
    const char* const cpu = attached.count(id) != 0 ? "attached" : "none";
    file << "  - {id: " << id << ", name: node" << id << ", cpu: " << cpu << "}\n";
  }
  return path;
}

namespace {

cpu_set_t allowed_cores() {
  cpu_set_t allowed;
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0)
    throw std::system_error(errno, std::generic_category(), "asking for the cores to run on");
  return allowed;
}

}  // namespace

unsigned core_count() {
  const cpu_set_t allowed = allowed_cores();
  return static_cast<unsigned>(CPU_COUNT(&allowed));
}

std::optional<cpu_set_t> cores_for(Pinning pinning) {
  if (pinning == Pinning::free) return {};
  const cpu_set_t allowed = allowed_cores();
  int last = CPU_SETSIZE - 1;
  while (last > 0 && !CPU_ISSET(last, &allowed)) --last;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(last, &one);
  return one;
}

void stay_on(const std::optional<cpu_set_t>& cores) {
  if (cores && ::sched_setaffinity(0, sizeof *cores, &*cores) != 0)
    throw std::system_error(errno, std::generic_category(), "pinning to a core");
}

namespace {

double cpu_seconds(pid_t process) {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &used) != 0)
    throw std::runtime_error("process " + std::to_string(process) + " has ended");
  return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

double cpu_seconds(const std::vector<pid_t>& processes) {
  double sum = 0;
  for (const pid_t process : processes) sum += cpu_seconds(process);
  return sum;
}

}  // namespace

CpuShare::CpuShare(std::vector<pid_t> processes) : processes_(std::move(processes)), before_(cpu_seconds(processes_)) {}

double CpuShare::percent() const {
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begun_;
  return 100 * (cpu_seconds(processes_) - before_) / passed.count();
}

namespace {

constexpr milliseconds kSettling{500};

std::optional<HostPort> reading_cpu(const PrivateRing& ring) {
  if (ring.config().nodes[0].cpu.kind != config::CpuConfig::Kind::attached) return {};
  return ring.connect(0, Role::cpu);
}

void let_pass(const Setup& setup, std::optional<HostPort>& cpu, steady_clock::duration time) {
  const auto end = steady_clock::now() + time;
  while (steady_clock::now() < end) {
    setup.poll();
    if (cpu)
      cpu->receive(kSlice);
    else
      std::this_thread::sleep_for(kSlice);
  }
}

}  // namespace

double measure_idle_percent(const Setup& setup, PrivateRing& ring) {
  std::optional<HostPort> cpu = reading_cpu(ring);
  let_pass(setup, cpu, kSettling);
  const CpuShare share(ring.processes());
  let_pass(setup, cpu,
           std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(setup.seconds)));
  return share.percent();
}

}  // namespace limb_ring::bench
