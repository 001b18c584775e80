#include "tools/ringctl/names_to_complete.h"

#include <algorithm>
#include <exception>
#include <set>

#include "limb_ring/ring_directory.h"
#include "ring/lock_files.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

namespace {

/// By what a daemon says, which knows the nodes of other hosts, too; where none can answer by what their files tell.
std::vector<std::string> node_names(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  const auto held = live::held_nodes(folder);
  const bool answers = std::any_of(
      held.begin(), held.end(), [&folder](const live::HeldNode& node) { return !live::is_frozen(folder, node.node); });
  std::vector<std::string> names;
  if (!answers) {
    for (const live::KnownNode& node : live::known_nodes(folder)) names.push_back(node.name);
    return names;
  }
  const RingAccess access = RingAccess::open(ring);
  for (const NodeName& node : access.nodes()) names.push_back(node.name);
  return names;
}

}  // namespace

std::vector<std::string> names_to_complete(const std::string& wanted, const std::string& ring) {
  if (wanted == "RING" || wanted == "--ring") return live::held_rings();
  const std::set<std::string> nodes{"NODE", "TO", "--to", "--from"};
  if (nodes.count(wanted) == 0) return {};
  try {
    return node_names(choose_ring(ring));
  } catch (const std::exception&) {
    return {};  // none runs, or several do
  }
}

std::string typed_ring(const std::vector<std::string>& words) {
  const std::string option = "--ring", with_value = option + '=';
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].compare(0, with_value.size(), with_value) == 0) return words[i].substr(with_value.size());
    if (words[i] == option && i + 1 < words.size()) return words[i + 1];
  }
  return {};
}

}  // namespace limb_ring::ringctl
