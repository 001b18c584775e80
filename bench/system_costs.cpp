#include "bench/system_costs.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "bench/private_ring.h"
#include "bench/ring_traffic.h"
#include "bench/setup.h"
#include "config/load_ring.h"
#include "io/unique_fd.h"
#include "limb_ring/host_port.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/packet_type.h"
#include "ring/launched_ring.h"

namespace limb_ring::bench {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kCostTime{100};

template <typename Once>
double us_each(Once once) {
  const auto begun = steady_clock::now();
  std::size_t times = 0;
  auto now = begun;
  for (; now - begun < kCostTime; now = steady_clock::now())
    for (int i = 0; i < 100; ++i, ++times) once();
  return std::chrono::duration<double, std::micro>(now - begun).count() / static_cast<double>(times);
}

struct Pipe {
  Pipe() {
    int ends[2];
    if (::pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "cannot make a pipe");
    from.reset(ends[0]);
    to.reset(ends[1]);
  }
  process::UniqueFd from, to;
};

bool pass(int from, int to) {
  char byte = 0;
  return ::read(from, &byte, 1) == 1 && ::write(to, &byte, 1) == 1;
}

struct Measured {
  std::atomic<bool> done{false};
  SystemCosts costs;
};

void measure(Pipe& there, Pipe& back, Measured& measured) {
  measured.costs.system_call = us_each([] { ::syscall(SYS_getppid); });
  const char first = 0;
  if (::write(there.to.get(), &first, 1) != 1) return;
  measured.costs.process_switch = us_each([&] { pass(back.from.get(), there.to.get()); }) / 2;
  measured.done = true;
}

}  // namespace

SystemCosts measure_system_costs() {
  const auto cores = cores_for(Pinning::one_core);
  Pipe there, back;
  Shared<Measured> measured(1);
  Worker echo([&] {
    stay_on(cores);
    while (pass(there.from.get(), back.to.get())) {
    }
  });
  Worker other([&] {
    stay_on(cores);
    measure(there, back, measured[0]);
  });
  while (other.running()) std::this_thread::sleep_for(kTick);
  if (!measured[0].done) throw std::runtime_error("the cost of a process switch could not be measured");
  return measured[0].costs;
}

namespace {

void replace(std::string& text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  if (at == std::string::npos) throw std::runtime_error("humanoid16.yaml has no '" + before + "' any more");
  text.replace(at, before.size(), after);
}

}  // namespace

std::string write_humanoid(const Setup& setup, const live::PrivateFolder& folder, unsigned state_rate,
                           const std::string& bridge) {
  std::ostringstream text;
  text << std::ifstream(setup.humanoid).rdbuf();
  std::string ring = text.str();
  replace(ring, "state_rate: 100 ", "state_rate: " + std::to_string(state_rate) + " ");
  replace(ring, "bridge:\n  rate: 50 ", "bridge:\n  " + bridge + " ");
  const std::string path = folder.path() + "/humanoid" + std::to_string(state_rate) + ".yaml";
  std::ofstream(path) << ring;
  return path;
}

namespace {

using std::chrono::nanoseconds;

constexpr const char* kRing = "bench-virtual";
/// Ring time from its start after which it is closed and every CPU runs.
constexpr std::chrono::milliseconds kJoined{100};
constexpr std::uint32_t kValidForUs = 100'000;
/// Real time that a daemon may take to start, and to end.
constexpr std::chrono::seconds kStart{10};
constexpr std::chrono::milliseconds kEndsWithin{2000};

/// Real time per ring time; a run that is slower is given up.
constexpr int kSlowest = 50;

double seconds(nanoseconds time) { return std::chrono::duration<double>(time).count(); }

/// The ring, which ends by itself after so many seconds of its time.
live::LaunchRequest launch_of(const config::RingConfig& ring, const std::string& path, double lasts_s) {
  live::LaunchRequest launch;
  launch.ring = kRing;
  launch.cores = cores_for(Pinning::one_core);
  launch.nodes.push_back(
      {wire::NodeId{ring.nodes.front().id},
       ring.nodes.front().name,
       {"--config", path, "--ring", kRing, "--clock", "virtual", "--pace", "max", "--for", std::to_string(lasts_s)},
       true});
  return launch;
}

/// Ends with this object at the latest.
class Daemon {
 public:
  explicit Daemon(live::LaunchRequest request) : ring_(std::move(request)) {}
  ~Daemon() {
    const auto wait = [](std::chrono::milliseconds time) {
      std::this_thread::sleep_for(time);
      return false;
    };
    ring_.end(wait, kEndsWithin);
  }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  std::string last_lines() const { return ring_.all().front().last_lines(); }

 private:
  live::LaunchedRing ring_;
};

HostPort connect(const config::RingConfig& ring) {
  ConnectOptions options;
  options.ring = kRing;
  options.node = std::to_string(ring.nodes.front().id);
  options.role = Role::cpu;
  options.results_may_wait = true;
  options.timeout = kStart;
  return HostPort::connect(options);
}

struct Outcome {
  std::atomic<bool> done{false};
  VirtualRate measured;
};

/// The CPU of the body: hears all states, and commands all joints.
class Controller {
 public:
  Controller(HostPort port, const config::RingConfig& ring, unsigned rate)
      : port_(std::move(port)), ring_(ring), rate_(rate) {}

  /// Until the ring ends.
  VirtualRate run() {
    const auto real = steady_clock::now();
    const nanoseconds begin = port_.now();
    nanoseconds due = begin + kJoined, end = begin;
    while (port_.connected()) {
      const auto message = port_.receive(std::max(due - port_.now(), nanoseconds(0)));
      if (!port_.connected()) break;
      end = port_.now();
      if (const auto* packet = message ? std::get_if<Packet>(&*message) : nullptr) hear(*packet);
      if (end < due) continue;
      due += nanoseconds(std::chrono::seconds(1)) / rate_;
      command_all();
    }
    VirtualRate result;
    result.state_rate = rate_;
    for (const auto& [node, states] : states_) {
      result.samples += states.received + states.missing;
      result.left_out += states.missing;
    }
    result.times_real_time = seconds(end - begin) / seconds(steady_clock::now() - real);
    return result;
  }

 private:
  struct States {
    std::uint64_t received = 0, missing = 0;
    std::uint16_t last = 0;
  };

  void hear(const Packet& packet) {
    if (packet.channel != payload::kJointChannel) return;
    const auto state = payload::decode_joint_state(packet.data);
    if (!state) return;
    States& states = states_[packet.source];
    if (states.received++ != 0) states.missing += static_cast<std::uint16_t>(state->sequence - states.last - 1);
    states.last = state->sequence;
  }

  void command_all() {
    payload::JointCommand command;
    command.sequence = ++sequence_;
    command.stamp_ns = port_.stamp().count();
    command.valid_for_us = kValidForUs;
    for (const config::NodeConfig& node : ring_.nodes) {
      if (node.joints.empty()) continue;
      command.joints.assign(node.joints.size(), {});
      for (std::size_t i = 0; i < node.joints.size(); ++i) command.joints[i].position = node.joints[i].initial;
      port_.send(node.id, *payload::encode(command), 0, payload::kJointChannel);
    }
  }

  HostPort port_;
  const config::RingConfig& ring_;
  unsigned rate_;  ///< Hz
  std::uint16_t sequence_ = 0;
  std::map<std::uint8_t, States> states_;
};

}  // namespace

VirtualRate measure_virtual_rate(const Setup& setup, const live::PrivateFolder& folder, unsigned state_rate) {
  setup.tell("humanoid at " + std::to_string(state_rate) + " Hz on a virtual clock");
  const std::string path = write_humanoid(setup, folder, state_rate, "lockstep: true");
  const config::RingConfig ring = config::load_ring(path);
  const Daemon daemon(launch_of(ring, path, seconds(kJoined) + setup.seconds));
  Shared<Outcome> outcome(1);
  Worker controller([&] {
    stay_on(cores_for(Pinning::one_core));
    outcome[0].measured = Controller(connect(ring), ring, state_rate).run();
    outcome[0].done = true;
  });
  if (!controller.sets(outcome[0].done, setup.poll, kPatience + kSlowest * setup.case_time()))
    throw std::runtime_error("a humanoid on a virtual clock did not come to its end" + daemon.last_lines());
  return outcome[0].measured;
}

}  // namespace limb_ring::bench
