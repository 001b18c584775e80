#include "ring/running_daemons.h"

#include <fcntl.h>
#include <netdb.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <system_error>
#include <thread>
#include <utility>

#include "io/node_notes.h"
#include "io/process_state.h"
#include "io/program.h"
#include "io/regular_file.h"
#include "io/spawn.h"
#include "io/unique_fd.h"
#include "limb_ring/ring_directory.h"
#include "ring/launched_ring.h"
#include "ring/observed_daemon.h"
#include "ring/ring_client.h"

namespace limb_ring::live {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kStep{5};
constexpr milliseconds kSignalled{5'000};  ///< for a signal to take effect
/// A fault may wait for a process to stop, and for lines.
constexpr milliseconds kAnswer{15'000};
/// For a reset, beside the time in which a CPU has to boot. The daemon itself gives up after 20 s.
constexpr milliseconds kReset{30'000};

bool wait_for(const std::function<bool()>& condition, milliseconds patience) {
  const auto deadline = steady_clock::now() + patience;
  while (!condition()) {
    if (steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kStep);
  }
  return true;
}

/// Whoever has asked a daemon in vain while it was frozen still stands before its door, and then has a client's place
/// until it is seen to be gone. That it does not run, or is frozen again, is for whoever asks it next.
bool lets_in(const std::function<void()>& connect, const std::function<bool()>& is_gone) {
  try {
    connect();
    return true;
  } catch (const HostPortError&) {
    return is_gone();
  } catch (const NotDone&) {
    return true;
  }
}

/// A node belongs to the ring once its hello, the first packet it sends, has come home.
bool has_said_hello(const status::NodeRow& row) { return row.state != "starting" && row.state != "joining"; }

/// Starts the daemon as it was started last, to outlive this process. @param output for what it prints
process::SpawnRequest as_last_time(const Holder& last, int output) {
  process::SpawnRequest request;
  request.path = last.program;
  request.arguments = last.arguments;
  request.arguments.insert(request.arguments.begin(), "ringd");
  request.folder = last.folder;
  request.output = output;
  request.group = process::SpawnRequest::Group::session;
  request.death_signal = 0;
  return request;
}

NotDone not_joined(const std::string& ring, const std::string& node, milliseconds patience) {
  return NotDone(with_standing_clock(
      "node " + node + " was started, but has not joined the ring within " + std::to_string(patience.count()) + " ms",
      ring));
}

}  // namespace

RunningDaemons::RunningDaemons(std::string ring, fault::RingNodes nodes)
    : ring_(std::move(ring)), nodes_(std::move(nodes)), folder_(ring_directory(ring_)) {}

std::vector<wire::NodeId> RunningDaemons::node_ids() const {
  std::vector<wire::NodeId> ids;
  for (const fault::NamedNode& node : nodes_) ids.push_back(node.id);
  return ids;
}

const fault::NamedNode& RunningDaemons::node(wire::NodeId id) const {
  return *std::find_if(nodes_.begin(), nodes_.end(), [id](const auto& node) { return node.id == id; });
}

HostPortError RunningDaemons::no_daemon(wire::NodeId id) const {
  return HostPortError("node " + node(id).name + " of ring " + ring_ + " has no daemon on this host that runs");
}

void RunningDaemons::require_runs(wire::NodeId id) const {
  if (!holder(id).held) throw no_daemon(id);
}

HostPort RunningDaemons::connect(wire::NodeId id) const {
  require_runs(id);
  if (is_frozen(id)) throw NotDone("node " + node(id).name + " is frozen: its daemon does not answer; thaw it first");
  return connect_node(ring_, node(id).number);
}

json RunningDaemons::ask(wire::NodeId id, const json& request) const {
  HostPort port = connect(id);
  return ask_through(port, request, kAnswer);
}

json RunningDaemons::ask_for_boot(wire::NodeId id, const json& request) const {
  HostPort port = connect(id);
  const json config = ask_through(port, {{"do", "config"}}, kAnswer);
  const milliseconds cpu_boot(config.at("cpu_boot_ms").get<milliseconds::rep>());
  return ask_through(port, request, cpu_boot + kReset);
}

json RunningDaemons::ask_ring(const json& request) const {
  HostPort port = connect_ring(ring_);
  return ask_through(port, request, kAnswer);
}

void RunningDaemons::wake_ring() const {
  const pid_t pid = holder(nodes_.front().id).pid;
  if (pid <= 0 || !process::is_stopped(pid)) return;
  if (::kill(pid, SIGCONT) != 0)
    throw NotDone("ring " + ring_ + ": pid " + std::to_string(pid) + ": " + std::strerror(errno));
  if (!wait_for([&] { return !process::is_stopped(pid); }, kSignalled))
    throw NotDone("the process of ring " + ring_ + " does not go on (does a debugger hold it?)");
  wait_for([&] { return lets_in([&] { connect_ring(ring_); }, [&] { return process::is_gone(pid); }); }, kSignalled);
}

json RunningDaemons::ask_through(HostPort& port, const json& request, milliseconds timeout) const {
  try {
    return ask_for_people(port, request, timeout);
  } catch (const HostPortTimeout& late) {
    throw NotDone(with_standing_clock(late.what(), ring_));
  } catch (const HostPortError& error) {
    if (!port.connected()) throw HostPortError("node " + port.name() + " of ring " + ring_ + ": " + error.what());
    throw NotDone(error.what());  // the daemon's own word
  }
}

bool RunningDaemons::is_frozen(wire::NodeId id) const { return holder(id).frozen; }

/// On a virtual ring the process is asked to do it: a signal would hit all of its nodes.
bool RunningDaemons::done_in_virtual_ring(fault::Name what, wire::NodeId id) const {
  if (!is_virtual()) return false;
  ask_ring({{"do", "fault"}, {"fault", fault::word_of(what).word + (' ' + node(id).number)}});
  return true;
}

// The pid is that of the lock's holder: no other process is hit.
pid_t RunningDaemons::pid_here(wire::NodeId id) const {
  const Holder holder = this->holder(id);
  if (!holder.held) throw no_daemon(id);
  // No process, or one of the kernel's, has a number that is of another pid namespace.
  std::error_code unknown;
  const auto has_program = [&] {
    return std::filesystem::exists("/proc/" + std::to_string(holder.pid) + "/exe", unknown) || unknown;
  };
  if (holder.pid <= 0 || !has_program())
    throw NotDone("the daemon of node " + node(id).name +
                  " cannot be seen among the processes here. If it runs in a container, do it there");
  return holder.pid;
}

void RunningDaemons::signal(wire::NodeId id, int number) const {
  const pid_t pid = pid_here(id);
  if (::kill(pid, number) != 0)
    throw NotDone("node " + node(id).name + ": pid " + std::to_string(pid) + ": " + std::strerror(errno));
}

void RunningDaemons::kill(wire::NodeId id) const {
  if (done_in_virtual_ring(fault::Name::kill, id)) return;
  const pid_t pid = pid_here(id);
  const Holder last = holder(id);
  const std::string problem = write_killed(folder_, id, pid);
  if (!problem.empty()) throw NotDone("node " + node(id).name + ": " + problem);
  signal(id, SIGKILL);
  // Whatever restarts the process (systemd, 'ringctl up --respawn') may have started the next daemon, which then holds
  // the lock.
  const auto is_replaced = [&](pid_t now) { return now > 0 && now != pid; };
  const auto gone = [&] { return process::is_gone(pid) || is_replaced(holder(id).pid); };
  if (!wait_for(gone, kSignalled)) throw NotDone("node " + node(id).name + " does not die");
  keep_holder(folder_, std::uint8_t{id}, last);
}

void RunningDaemons::freeze(wire::NodeId id) const {
  if (done_in_virtual_ring(fault::Name::freeze, id)) return;
  signal(id, SIGSTOP);
  if (!wait_for([&] { return is_frozen(id); }, kSignalled)) throw NotDone("node " + node(id).name + " does not stop");
}

void RunningDaemons::thaw(wire::NodeId id) const {
  if (done_in_virtual_ring(fault::Name::thaw, id)) return;
  signal(id, SIGCONT);
  if (!wait_for([&] { return !is_frozen(id); }, kSignalled))
    throw NotDone("node " + node(id).name + " does not go on (does a debugger hold it?)");
  wait_for([&] { return lets_in([&] { connect(id); }, [&] { return !holder(id).held; }); }, kSignalled);
}

void RunningDaemons::start(wire::NodeId id, milliseconds patience) const {
  if (done_in_virtual_ring(fault::Name::start, id)) return wait_for_hello(id, patience);
  const Holder last = holder(id);
  if (last.held)
    throw NotDone("node " + node(id).name + " runs already" +
                  (last.pid > 0 ? ", pid " + std::to_string(last.pid) : ""));
  if (last.program.empty())
    throw NotDone("node " + node(id).name + " has never run on this host, so nobody knows how to start it");
  const bool killed = is_killed(folder_, id);
  const std::string log = folder_ + "/" + node(id).number + ".log";
  const process::UniqueFd output = process::open_regular(log, O_WRONLY | O_CREAT | O_APPEND);
  if (!output.valid()) throw NotDone("cannot write " + log + ": " + process::why_not_opened(log));
  process::Child daemon(process::spawn(as_last_time(last, output.get())), last.program);
  // If it has ended and the node runs all the same, somebody else has started it.
  const auto in_vain = [&] { return (daemon.reap() || daemon.ended()) && !holder(id).held; };
  const bool in_time = wait_for([&] { return has_joined(id) || in_vain(); }, patience);
  if (in_vain()) {
    if (killed) write_killed(folder_, id, holder(id).pid);  // it stays so: this one has only left its pid
    throw NotDone("node " + node(id).name + " cannot be started: " + daemon.ended()->text +
                  process::last_lines_of(log));
  }
  keep(std::move(daemon));
  if (!in_time) throw not_joined(ring_, node(id).name, patience);
}

void RunningDaemons::keep(process::Child daemon) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  started_.push_back(std::move(daemon));
  const auto has_ended = [](process::Child& child) { return child.reap() || child.ended(); };
  started_.erase(std::remove_if(started_.begin(), started_.end(), has_ended), started_.end());
}

status::NodeRow RunningDaemons::row_of(wire::NodeId id) const {
  status::NodeRow row;
  const std::string wrong = status::read(ask(id, {{"do", "status"}}), row);
  if (!wrong.empty()) throw NotDone("node " + node(id).name + ": " + ask::sentence_of_shape(wrong));
  return row;
}

// A daemon that starts anew lets go of its lock for a moment, and lives. Of one in a container, where its pid means
// nothing here, nobody can tell the two apart.
bool RunningDaemons::wait_while_it_lives(wire::NodeId id, const std::function<bool()>& condition,
                                         milliseconds patience) const {
  const Holder before = holder(id);
  const bool unseen = before.held && process::is_gone(before.pid);
  const auto has_ended = [&] { return !unseen && process::is_gone(before.pid) && !holder(id).held; };
  const bool in_time = wait_for([&] { return condition() || has_ended(); }, patience);
  const std::string log = folder_ + "/" + node(id).number + ".log";
  if (has_ended())
    throw NotDone("the daemon of node " + node(id).name + " has ended, as where 'ringctl down' ends its ring" +
                  (std::filesystem::exists(log) ? process::last_lines_of(log) : ""));
  return in_time;
}

// The daemon sends no answer, because it ends. A higher boot number shows that it has come back.
void RunningDaemons::power_cycle(wire::NodeId id) const {
  if (done_in_virtual_ring(fault::Name::power_cycle, id)) return wait_for_hello(id);
  const auto before = row_of(id).boot;
  HostPort port = connect(id);
  const json request{{"do", "fault"}, {"fault", "power_cycle " + node(id).number}};
  try {
    port.ask(request.dump(), kAnswer);
  } catch (const HostPortError& error) {
    if (port.connected()) throw NotDone("node " + node(id).name + ": " + error.what());
  }
  const auto is_new = [&] {
    try {
      return row_of(id).boot > before;
    } catch (const HostPortError&) {
      return false;  // not yet there
    }
  };
  if (!wait_while_it_lives(id, is_new, kComesUp)) throw NotDone("node " + node(id).name + " does not come back");
  wait_for_hello(id);
}

bool RunningDaemons::has_joined(wire::NodeId id) const {
  try {
    return has_said_hello(row_of(id));
  } catch (const HostPortError&) {
    return false;
  }
}

void RunningDaemons::wait_for_hello(wire::NodeId id, milliseconds patience) const {
  if (const Holder last = holder(id); !last.held && last.program.empty()) return;  // foreign: it cannot be asked
  if (!wait_while_it_lives(
          id, [&] { return has_joined(id); }, patience))
    throw not_joined(ring_, node(id).name, patience);
}

// Tries to bind rather than listing interfaces: no interface has 127.0.0.2, and yet it is this machine's own.
bool is_own_address(const std::string& address) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_PASSIVE;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.c_str(), nullptr, &hints, &found) != 0) return false;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> freed(found, ::freeaddrinfo);
  const process::UniqueFd socket(::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  return socket.valid() && ::bind(socket.get(), found->ai_addr, found->ai_addrlen) == 0;
}

}  // namespace limb_ring::live
