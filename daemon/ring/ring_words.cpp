#include "ring/ring_words.h"

#include <algorithm>

namespace limb_ring::ask {

namespace {

/// Nodes learn the ring's size by the HOP of their own packets. For a moment it may be that of before.
std::string other_size(const std::vector<NodeInRing>& nodes, std::size_t up) {
  if (up != nodes.size()) return "";
  for (const NodeInRing& node : nodes)
    if (node.ring_size != 0 && node.ring_size != up)
      return ", but by HOP the ring has " + std::to_string(node.ring_size);
  return "";
}

}  // namespace

std::string ring_in_words(const std::vector<NodeInRing>& nodes, const std::string& broken_line) {
  std::size_t up = 0, folded = 0, open = 0, part = nodes.size();
  for (const NodeInRing& node : nodes) {
    open += node.state == "open_chain" ? 1 : 0;
    up += node.state == "up" || node.state == "folded" ? 1 : 0;
    if (node.state != "folded") continue;
    ++folded;
    if (node.ring_size != 0) part = std::min(part, node.ring_size);
  }
  const std::string working = std::to_string(up + open) + " of " + std::to_string(nodes.size()) + " nodes ";
  if (open != 0) return working + "work, open chain" + (broken_line.empty() ? "" : ": line " + broken_line + " broken");
  if (folded == 0) return working + "up" + other_size(nodes, up);
  // Of two breaks each part is a ring of its own.
  return working + (part < up ? "up, folded back in parts" : "up, folded back around a break");
}

std::string way_to_first_of_chain(const std::string& node) {
  return "mend the line, or let its daemon restart its CPU: 'ringctl fault reset " + node + "'";
}

}  // namespace limb_ring::ask
