#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "io/regular_file.h"
#include "io/signal_wait.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

namespace fs = std::filesystem;

/// A ring that has ended by itself is no longer running, and is asked about all the same.
std::string ring_of_logs(const std::string& given) {
  try {
    return choose_ring(given);
  } catch (const NoRing&) {
    std::vector<std::string> ended;
    for (const fs::path folder : live::files_in(fs::path(live::kept_logs(rings_directory() + "/x")).parent_path()))
      ended.push_back(folder.filename());
    if (ended.size() != 1) throw;
    return ended.front();
  }
}

/// The name in the first line of a daemon's log: "07:45:08.123 info [leg8/knee] ..."; empty if it came to none.
std::string name_in(const std::string& log, const std::string& ring) {
  const std::string text = process::text_of_regular(log), before = "[" + ring + "/";
  const std::size_t begin = text.find(before), end = text.find(']', begin);
  if (begin == std::string::npos || end == std::string::npos) return {};
  return text.substr(begin + before.size(), end - begin - before.size());
}

/// @throw NoRing, NotDone, Elsewhere, UsageError naming why there is none
std::string log_for(const std::string& ring, const std::string& node) {
  const std::string folder = ring_directory(ring), kept = live::kept_logs(folder);
  const bool runs = !live::held_nodes(folder).empty();
  std::vector<NodeName> nodes;
  for (const std::string& where : {folder, kept}) {
    for (const std::string& log : live::files_in(where)) {
      if (fs::path(log).filename() == live::kRingLog) return log;
      const auto id = live::node_of(log, ".log");
      if (!id) continue;
      nodes.push_back({*id, name_in(log, ring)});
      if (node == std::to_string(*id) || node == nodes.back().name) return log;
    }
    if (runs || !nodes.empty()) break;
  }
  if (!runs && nodes.empty()) throw NoRing("ring " + ring + " has left no logs");
  if (!runs) throw unknown_node(node, ring, nodes);
  const RingAccess access = RingAccess::open_also_dead(ring);
  access.require_here(access.node(node));
  throw NotDone("node " + node + " of ring " + ring +
                " has no log: its daemon and its CPU print where 'ringctl up' or roslaunch was started. "
                "'ringctl up --detach' keeps it");
}

/// Prints what has come since the last call. A file that has become shorter was begun anew.
void print_new(const process::UniqueFd& file, off_t& printed) {
  const off_t size = ::lseek(file.get(), 0, SEEK_END);
  if (size < printed) printed = 0;
  std::string part(64 * 1024, '\0');
  for (ssize_t got; (got = ::pread(file.get(), part.data(), part.size(), printed)) > 0; printed += got)
    std::cout.write(part.data(), got);
  std::cout.flush();
}

int show(const std::string& ring, const std::string& node, bool follow) {
  const std::string path = log_for(ring, node);
  if (fs::path(path).filename() == live::kRingLog)
    tell_user("ring " + ring + " is virtual: all its nodes print into one log");
  const process::UniqueFd file = process::open_regular(path);
  if (!file.valid()) throw NotDone("cannot read " + path + ": " + process::why_not_opened(path));
  off_t printed = 0;
  process::SignalWait signals;
  for (;;) {
    // Asked before the last look: what was printed until then is shown.
    const bool goes_on = follow && fs::path(path).parent_path() == ring_directory(ring) && fs::exists(path);
    print_new(file, printed);
    if (!follow || !std::cout) return kDone;
    if (!goes_on) {
      tell_user("ring " + ring + " has ended");
      return kDone;
    }
    if (signals.asked_to_end(process::SignalWait::kTick)) return kDone;
  }
}

}  // namespace

void add_log(CLI::App& app, Context& context) {
  auto node = std::make_shared<std::string>();
  auto follow = std::make_shared<bool>(false);
  CLI::App* command = add_command(
      app, "log", "Show what a node's daemon and its CPU printed", "ringctl log left_knee -f",
      "Works if 'ringctl up --detach' has started the ring, also after the ring has ended, until it is started again. "
      "Without --detach, they print where 'ringctl up' runs. All nodes of a virtual ring print into one log.");
  command->add_option("NODE", *node, "Name or id of the node")->required();
  command->add_flag("-f,--follow", *follow, "Keep printing, until the ring ends or Ctrl-C");
  command->callback([&context, node, follow] {
    context.action = [&context, node, follow] { return show(ring_of_logs(context.ring), *node, *follow); };
  });
}

}  // namespace limb_ring::ringctl
