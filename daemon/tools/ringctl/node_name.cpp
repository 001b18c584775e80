#include "tools/ringctl/node_name.h"

#include "config/names.h"

namespace limb_ring::ringctl {

std::string label(const NodeName& node) { return std::to_string(node.id) + " (" + node.name + ")"; }

UsageError unknown_node(const std::string& word, const std::string& ring, const std::vector<NodeName>& nodes) {
  std::vector<std::string> labels, names;
  for (const NodeName& node : nodes) {
    labels.push_back(label(node));
    names.push_back(node.name);
  }
  const std::string meant = config::closest(word, names);
  return UsageError("unknown node '" + word + "'" + (meant.empty() ? ". " : ", did you mean '" + meant + "'? ") +
                    "Ring " + ring + " has: " + config::join(labels));
}

}  // namespace limb_ring::ringctl
