#include "tools/ringctl/respawn.h"

#include <algorithm>

#include "io/node_notes.h"
#include "limb_ring/ring_directory.h"
#include "ring/lock_files.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/tell_user.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;

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
