#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "io/regular_file.h"
#include "judge/flight_recorder.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/up.h"

namespace limb_ring::ringctl {
namespace {

std::vector<NodeName> nodes_with_sockets(const std::string& ring) {
  std::vector<NodeName> nodes;
  for (const std::uint8_t id : node_sockets(ring)) nodes.push_back({id, std::to_string(id)});
  return nodes;
}

/// @return true if every daemon has a socket and has said yes
bool ask_to_end(const std::string& ring, std::size_t daemons) {
  const auto answers = ask_all(ring, nodes_with_sockets(ring), {{"do", "shutdown"}});
  const auto agreed =
      std::count_if(answers.begin(), answers.end(), [](const ask::Answer& answer) { return answer.said.has_value(); });
  return static_cast<std::size_t>(agreed) == daemons;
}

bool end_ring(const std::string& ring, const std::string& folder) {
  Progress progress;
  if (!ask_to_end(ring, live::held_nodes(folder).size())) terminate_daemons(folder);
  if (wait_until_gone(folder, progress)) return true;
  terminate_daemons(folder);
  if (wait_until_gone(folder, progress)) return true;
  signal_daemons(folder, SIGKILL);
  return wait_until_gone(folder, progress);
}

int tell_down(const std::string& ring) {
  std::cout << "ring " << ring << " is down" << std::endl;
  return kDone;
}

/// Tidies the folder of a ring that does not run. Who begins to start it meanwhile waits for our lock, or makes the
/// folder again. @throw NotDone if somebody is just starting it
void remove_what_is_left(const std::string& ring, const std::string& folder) {
  std::optional<process::LockFile> lock;
  if (::access(folder.c_str(), W_OK | X_OK) != 0) return;
  std::string starting = live::held_up_lock(folder);
  if (starting.empty() && !(lock = process::LockFile::take(up_lock(folder)))) starting = up_lock(folder);
  if (!starting.empty())
    throw NotDone("ring " + ring + " is being started, by " + process::lock_holder(starting) +
                  "; once it is up, 'ringctl down " + ring + "' ends it");
  live::remove_leftovers(folder);
}

int run(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  tell_unreadable(folder);
  if (live::held_nodes(folder).empty()) {
    const std::string unreadable = why_unreadable(folder);
    if (!unreadable.empty()) throw NoRing("ring " + ring + ": " + folder + unreadable);
    const auto killed = live::killed_rings();
    remove_what_is_left(ring, folder);
    if (std::count(killed.begin(), killed.end(), ring) != 0) return tell_down(ring);
    throw NoRing("ring " + ring + " is not running");
  }
  if (!end_ring(ring, folder))
    throw NotDone("ring " + ring + ": " + app::counted(live::held_nodes(folder).size(), "daemon") +
                  " left that even SIGKILL does not end");
  live::remove_leftovers(folder);
  return tell_down(ring);
}

/// Tidies the folders of rings that nobody has ended; not where their daemons have recorded what may tell why.
void tidy_those_left() {
  for (const std::string& ring : live::left_rings()) {
    const std::string folder = ring_directory(ring);
    if (!recorder::recordings_in(folder).empty()) continue;
    try {
      remove_what_is_left(ring, folder);
    } catch (const NotDone&) {  // somebody is just starting it
    } catch (const std::runtime_error& problem) {
      tell_user(problem.what());
    }
  }
}

/// Ends all rings of this user. @return an ExitCode; kDone also if there is none. @throw NotDone with what is left
int run_all() {
  tell_unreadable_rings();
  std::vector<std::string> rings = live::held_rings();
  for (const std::string& ring : live::killed_rings()) rings.push_back(ring);
  tidy_those_left();
  std::string left;
  for (const std::string& ring : rings) {
    try {
      run(ring);
    } catch (const NoRing&) {  // somebody else has ended it meanwhile
    } catch (const std::runtime_error& problem) {
      left += (left.empty() ? "" : "; ") + std::string(problem.what());
    }
  }
  if (!left.empty()) throw NotDone(left);
  if (rings.empty()) std::cout << "no ring is running" << std::endl;
  return kDone;
}

}  // namespace

void add_down(CLI::App& app, Context& context) {
  auto ring = std::make_shared<std::string>();
  CLI::App* command =
      add_command(app, "down", "End a ring", "ringctl down leg8",
                  "Asks the daemons to end. One that does not end gets SIGTERM, then SIGKILL. Then removes the ring's "
                  "folder. The log files stay in .logs/RING beside it until the ring is started again.");
  auto all = std::make_shared<bool>(false);
  CLI::Option* name = command->add_option("RING", *ring, "Name of the ring; default: as --ring");
  command->add_flag("--all", *all, "All rings of this user")->excludes(name);
  command->callback([&context, ring, all] {
    context.action = [&context, ring, all] {
      if (*all && !context.ring.empty()) throw UsageError("--all and --ring: choose one of them");
      return *all ? run_all() : run(choose_ring(*ring, context.ring));
    };
  });
}

}  // namespace limb_ring::ringctl
