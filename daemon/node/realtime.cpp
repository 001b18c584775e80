#include "node/realtime.h"

#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "io/program.h"
#include "io/spawn.h"
#include "node/host_server.h"

namespace limb_ring::runtime {
namespace {

void pin_to(const std::vector<unsigned>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const unsigned core : cores) CPU_SET(core, &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0)
    spdlog::warn("realtime.cores: {} (does this machine have these cores?); going on unpinned", std::strerror(errno));
}

std::vector<unsigned> allowed_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<unsigned> cores;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return {0};
  for (unsigned core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  return cores;
}

void ask_for_fifo(int priority) {
  sched_param param{};
  param.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &param) != 0)
    spdlog::warn("realtime.fifo: {} (needs CAP_SYS_NICE or an rtprio limit); going on without", std::strerror(errno));
}

void lock_memory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    spdlog::warn("realtime.lock_memory: {} (needs CAP_IPC_LOCK or a memlock limit); going on without",
                 std::strerror(errno));
}

}  // namespace

unsigned core_of(std::size_t place, std::size_t nodes, const std::vector<unsigned>& allowed) {
  return allowed[place * allowed.size() / nodes];
}

void apply_realtime(const config::RingConfig& ring, std::size_t place) {
  const config::Realtime& realtime = ring.realtime;
  if (realtime.auto_cores) pin_to({core_of(place, ring.nodes.size(), allowed_cores())});
  if (!realtime.cores.empty()) pin_to(realtime.cores);
  if (realtime.fifo > 0) ask_for_fifo(realtime.fifo);
  if (realtime.lock_memory) lock_memory();
}

void keep_on_one_core(const config::RingConfig& ring) {
  const int here = sched_getcpu();
  if (!ring.realtime.cores.empty())
    pin_to(ring.realtime.cores);
  else if (here >= 0)
    pin_to({static_cast<unsigned>(here)});
}

namespace {

std::vector<std::string> own_command_line() {
  std::ifstream file("/proc/self/cmdline");
  std::vector<std::string> arguments;
  for (std::string argument; std::getline(file, argument, '\0');) arguments.push_back(argument);
  return arguments;
}

}  // namespace

void re_exec(const std::optional<cpu_set_t>& cores) {
  const std::vector<std::string> arguments = own_command_line();
  process::close_descriptors_on_exec();
  if (cores) ::sched_setaffinity(0, sizeof *cores, &*cores);
  const int error = process::execute("/proc/self/exe", arguments);
  spdlog::critical("ends: cannot execute this program again: {}", std::generic_category().message(error));
  ::_exit(1);  // as by kill -9: its CPU is gone already
}

namespace {

/// Beside its clients: both lines, timers, files, its CPU, and handshakes that are under way.
constexpr unsigned kOfTheNode = 48;

}  // namespace

std::string too_few_descriptors(const config::RingConfig& ring) {
  const rlim_t needed = kOfTheNode + ring.limits.clients + host::HostServer::kKeptPlaces;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= needed) return "";
  return "only " + std::to_string(limit.rlim_cur) +
         " file descriptors may be open (ulimit -n), this node needs up to " + std::to_string(needed);
}

namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLookEvery{2};

struct Wait : std::enable_shared_from_this<Wait> {
  Wait(boost::asio::io_context& io, std::weak_ptr<void> whose, std::function<bool()> what, steady_clock::time_point end,
       std::function<void(bool)> tell)
      : owner(std::move(whose)), condition(std::move(what)), deadline(end), done(std::move(tell)), timer(io) {}

  void poll() {
    if (owner.expired()) return;
    if (condition()) return done(true);
    if (steady_clock::now() >= deadline) return done(false);
    timer.expires_after(kLookEvery);
    timer.async_wait([self = shared_from_this()](const auto& error) {
      if (!error) self->poll();
    });
  }

  std::weak_ptr<void> owner;
  std::function<bool()> condition;
  steady_clock::time_point deadline;
  std::function<void(bool)> done;
  boost::asio::steady_timer timer;
};

}  // namespace

void wait_until(boost::asio::io_context& io, const std::shared_ptr<void>& owner, std::function<bool()> condition,
                std::chrono::milliseconds patience, std::function<void(bool)> done) {
  std::make_shared<Wait>(io, owner, std::move(condition), steady_clock::now() + patience, std::move(done))->poll();
}

}  // namespace limb_ring::runtime
