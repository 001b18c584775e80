#include "ring/status_rows.h"

#include <algorithm>
#include <optional>

#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"

namespace limb_ring::ask {
namespace {

constexpr int kLately = 1000;  ///< ms; an older beacon tells nothing

}  // namespace

Rows status_rows(const std::string& ring, const std::vector<Node>& nodes, std::chrono::milliseconds timeout) {
  Rows rows;
  for (ToldRow& told : RingClient(ring, nodes).status(std::chrono::steady_clock::now() + timeout))
    if (told.said) rows.emplace(told.said->id, std::move(*told.said));
  return rows;
}

Rows status_rows_here(const std::string& ring, std::chrono::milliseconds timeout) {
  std::vector<Node> nodes;
  for (const live::HeldNode& held : live::held_nodes(ring_directory(ring))) nodes.push_back({held.node, ""});
  return status_rows(ring, nodes, timeout);
}

const status::Heard* lately_heard_in(const status::NodeRow& row, std::uint8_t node) {
  for (const status::Heard& heard : row.heard)
    if (heard.id == node && heard.age_ms < kLately) return &heard;
  return nullptr;
}

const status::Heard* lately_heard(const Rows& rows, std::uint8_t node) {
  const status::Heard* newest = nullptr;
  for (const auto& [id, row] : rows) {
    const status::Heard* heard = lately_heard_in(row, node);
    if (heard != nullptr && (newest == nullptr || heard->age_ms < newest->age_ms)) newest = heard;
  }
  return newest;
}

std::optional<std::uint8_t> who_reaches(const Rows& rows, std::uint8_t target) {
  const auto row = rows.find(target);
  if (row == rows.end()) return std::nullopt;
  // The newest beacon: others may be from before the ring broke.
  const status::Heard* newest = nullptr;
  for (const auto& [id, unused] : rows) {
    const status::Heard* heard = id == target ? nullptr : lately_heard_in(row->second, id);
    if (heard != nullptr && (newest == nullptr || heard->age_ms < newest->age_ms)) newest = heard;
  }
  return newest == nullptr ? std::nullopt : std::optional(newest->id);
}

std::string name_of(const std::vector<Node>& nodes, std::uint8_t id) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const Node& node) { return node.id == id; });
  return found == nodes.end() ? "node " + std::to_string(id) : found->name;
}

const std::vector<ErrorCounter>& error_counters() {
  using Of = ErrorCounter::Of;
  static const std::vector<ErrorCounter> counters{
      {Of::input, "crc_errors", true},
      {Of::input, "malformed_packets", true},
      {Of::input, "stray_slices", false},
      {Of::input, "oversize_packets", true},
      {Of::input, "stalled_packets", true},
      {Of::input, "broken_off_packets", true},
      {Of::input, "input_losses", false},
      {Of::input, "input_malformed", false},
      {Of::input, "input_datagrams_lost", true},  // each held packets, or a part of one
      {Of::input, "input_datagrams_duplicate", false},
      {Of::input, "input_delay_dropped", false},
      {Of::output, "output_losses", false},
      {Of::output, "output_discarded", false},
      {Of::output, "output_datagrams_unsent", false},
      {Of::output, "dropped_no_output", true},
      {Of::node, "ended_lost", true},
      {Of::node, "ended_refused", false},
      {Of::node, "timeouts", true},
      {Of::node, "returns_damaged", true},
      {Of::node, "returns_unmatched", false},
      {Of::node, "refused_no_buffer", false},
      {Of::node, "insertion_buffer_full", true},
      {Of::node, "interrupt_buffer_full", true},
      {Of::node, "flushed_on_reset", false},
      {Of::node, "orphans_hop", false},
      {Of::node, "duplicate_id_signs", false},
      {Of::node, "host_slow_clients", false},
      {Of::node, "host_interrupts_lost", false},
  };
  return counters;
}

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
