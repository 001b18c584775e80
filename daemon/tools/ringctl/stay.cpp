#include "tools/ringctl/stay.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "io/node_notes.h"
#include "io/process_state.h"
#include "io/program.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;

namespace {

constexpr milliseconds kGraceOfRing{3000};

}  // namespace

void announce(const RingPlan& plan, RingWatch& watch) {
  const std::size_t ring_size = watch.ring_size();
  const std::string here = std::to_string(plan.nodes.size());
  std::string text = "ring " + plan.ring;
  if (!plan.is_part())
    text += " is closed: " + here + " nodes up";
  else if (ring_size == plan.ring_size)
    text += " is closed: " + std::to_string(ring_size) + " nodes up, " + here +
            (plan.host.empty() ? " of them daemons" : " of them here, on host " + plan.host);
  else {
    const std::string refusal = watch.refusal();
    text += (plan.host.empty() ? ": all daemons" : ": all nodes of host " + plan.host) + std::string(" are up (") +
            here + "), " + std::to_string(ring_size) + " of " + std::to_string(plan.ring_size) + " are in the ring" +
            (!refusal.empty()    ? refusal
             : plan.host.empty() ? "; 'ringctl wait up' waits for the foreign ones"
                                 : "; 'ringctl wait up' waits for the other hosts");
  }
  std::cout << text << std::endl;
  process::tell_ready(text);
}

void end(live::LaunchedRing& daemons, process::SignalWait& signals) {
  daemons.end([&signals](milliseconds time) { return signals.asked_to_end(time); }, kGraceOfRing);
}

namespace {

void tell_ended(live::LaunchedRing& daemons) {
  for (const live::LaunchedDaemon* daemon : daemons.reap())
    if (!daemon->ended()->clean) tell_user(daemon->exit_reason());
}

/// Ends daemons that were killed on purpose and started again by 'ringctl fault start': they are not our children, but
/// have to end with the ring.
void end_restarted(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  terminate_daemons(folder);
  Progress progress;
  wait_until_gone(folder, progress);
}

/// Ends all that is left of the ring, by a signal. The folder of a part stays: the nodes of other hosts know these by
/// their boot numbers.
void end_all(const RingPlan& plan, live::LaunchedRing& daemons, process::SignalWait& signals) {
  end(daemons, signals);
  end_restarted(plan.ring);
  if (!plan.is_part()) tidy_folder(plan.ring);
}

}  // namespace

int stay(const RingPlan& plan, live::LaunchedRing& daemons, process::SignalWait& signals, bool has_end) {
  const RingFolder folder(plan.ring);
  while (daemons.any_running()) {
    if (signals.asked_to_end(milliseconds(1000))) {
      end_all(plan, daemons, signals);
      return kDone;
    }
    tell_ended(daemons);
  }
  end_restarted(plan.ring);
  const bool clean = std::all_of(daemons.all().begin(), daemons.all().end(),
                                 [](const live::LaunchedDaemon& daemon) { return daemon.ended()->clean; });
  if (clean && has_end && !folder.is_gone()) tidy_folder(plan.ring);
  return clean ? kDone : kNotDone;
}

namespace {

/// Gives up on a daemon that exits with an error before the ring was ever closed: it would fail again.
void require_started(const live::LaunchedRing& daemons) {
  const live::LaunchedDaemon* dead = daemons.first_ended();
  if (dead != nullptr && !dead->ended()->clean && !dead->ended()->by_signal) throw NotDone(dead->exit_reason());
}

void tell_taken_down(const std::string& ring) {
  std::cout << "ring " << ring << " was taken down; 'ringctl up --detach' starts it again, and Ctrl-C ends this"
            << std::endl;
}

/// Until a signal, whatever ends the daemons; if the ring was taken down, also until whoever started us is gone,
/// such as a roslaunch that was killed: nobody else would end us. @throw NotDone if one cannot start
void stay_and_respawn(const RingPlan& plan, live::LaunchedRing& daemons, process::SignalWait& signals, UpLock& lock) {
  Respawn respawn(daemons);
  std::optional<RingWatch> watch(plan);
  Progress progress;
  bool down = false;
  const pid_t starter = ::getppid();
  while (!signals.asked_to_end(Respawn::kTick)) {
    daemons.reap();
    if (watch) require_started(daemons);
    respawn.poll();
    if (!down && respawn.taken_down()) {
      tell_taken_down(plan.ring);
      lock.release();
      watch.reset();
      down = true;
    }
    if (down && ::getppid() != starter) return;
    if (!watch) continue;
    if (const auto waiting = watch->first_not_ready()) {
      progress.tell("waiting for " + waiting->lack);
    } else {
      lock.release();
      announce(plan, *watch);
      watch.reset();
    }
  }
  if (down) return;  // daemons that run now were started by somebody else
  end_all(plan, daemons, signals);
}

}  // namespace

std::optional<process::Program> start_keeper(const RingPlan& plan, process::Lifetime lifetime) {
  if (plan.keeper.empty()) return std::nullopt;
  process::ProgramRequest request;
  request.name = process::own_folder() + "/ringctl";
  request.arguments = plan.keeper;
  request.lifetime = lifetime;
  if (lifetime == process::Lifetime::its_own) request.log = ring_directory(plan.ring) + "/keep.log";
  return process::Program(request);
}

int respawn(const RingPlan& plan, UpLock& lock) {
  process::SignalWait signals;
  live::LaunchedRing daemons(launch_request(plan, process::Lifetime::asked_to_end));
  const auto keeper = start_keeper(plan, process::Lifetime::asked_to_end);
  try {
    stay_and_respawn(plan, daemons, signals, lock);
  } catch (const NotDone& problem) {
    end(daemons, signals);
    throw NotDone("ring " + plan.ring + ": " + problem.what());
  }
  return kDone;
}

namespace {

constexpr process::BackOff::Limits kPauses{milliseconds(500), milliseconds(10000), milliseconds(10000)};
/// Longer than 'ringctl down' may take. If a daemon that is not our child is gone, we cannot tell a crash from 'ringctl
/// down', so we wait this long for the latter to finish.
constexpr milliseconds kDownTakes{8000};

std::string label_of(const live::LaunchedDaemon& daemon) {
  return daemon.all ? "the virtual ring" : "node " + label({daemon.id, daemon.name});
}

}  // namespace

Respawn::Respawn(live::LaunchedRing& daemons) : daemons_(daemons), folder_(ring_directory(daemons.ring())) {
  Node node{Plan::runs, Clock::now(), {}, process::BackOff(kPauses), false};
  nodes_.assign(daemons.all().size(), node);
}

void Respawn::poll() {
  daemons_.reap();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].plan == Plan::runs && daemons_.all()[i].ended()) ended(i);
    if (nodes_[i].plan == Plan::starts_again) consider(i);
  }
}

bool Respawn::taken_down() const {
  return std::all_of(nodes_.begin(), nodes_.end(), [](const Node& node) { return node.plan == Plan::stays_down; });
}

void Respawn::ended(std::size_t index) {
  Node& node = nodes_[index];
  const live::LaunchedDaemon& daemon = daemons_.all()[index];
  const auto ran = std::chrono::duration_cast<milliseconds>(Clock::now() - node.started);
  // A clean end is one that was asked for: 'ringctl down', SIGTERM.
  node.plan = daemon.ended()->clean ? Plan::stays_down : Plan::starts_again;
  node.due = Clock::now() + node.pause.after(ran);
  node.told = false;
  if (!daemon.ended()->clean) tell_user(daemon.exit_reason());
}

/// 'ringctl down' removes the lock files in the end; nothing else does.
void Respawn::consider(std::size_t index) {
  Node& node = nodes_[index];
  const live::LaunchedDaemon& daemon = daemons_.all()[index];
  const NodeName name{daemon.id, daemon.name};
  const live::Holder holder = live::holder_of(folder_, name.id);
  if (holder.held || holder.on_virtual_ring)  // 'ringctl fault start', or another 'ringctl up'
    node.due = Clock::now() + kDownTakes;
  else if (holder.pid < 0)
    node.plan = Plan::stays_down;
  else if (Clock::now() < node.due)
    return;
  else if (daemon.all || !live::is_killed(folder_, wire::NodeId{name.id}))
    start(index);
  else if (!std::exchange(node.told, true))
    tell_user("node " + label(name) + " was killed on purpose; 'ringctl fault start " + name.name +
              "' starts it again");
}

void Respawn::start(std::size_t index) {
  tell_user(label_of(daemons_.all()[index]) + " is started again");
  daemons_.start_again(index);
  nodes_[index].plan = Plan::runs;
  nodes_[index].started = Clock::now();
}

}  // namespace limb_ring::ringctl
