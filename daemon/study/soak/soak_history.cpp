#include "study/soak/soak_history.h"

namespace limb_ring::study {

using scenario::SoakAction;
using wire::NodeId;

void SoakHistory::add(fault::Name name, NodeId node) {
  fault::Fault fault;
  fault.name = name;
  fault.nodes = {node};
  add(fault);
}

void SoakHistory::add(SoakAction::Kind kind, NodeId node, bool second_line) {
  SoakAction action;
  action.kind = kind;
  action.node = node;
  action.second_line = second_line;
  add(action);
}

void SoakHistory::count_slice(NodeId node, core::Line line) {
  if (!kept_) return;
  auto& nodes = leaving_[static_cast<std::size_t>(line)];
  if (nodes.empty()) nodes.resize(ring_.size());
  AtInstant& leaving = nodes[node];
  if (leaving.at != ring_.now()) leaving = {ring_.now(), 0};
  ++leaving.slices;
}

void SoakHistory::add_slice(SoakAction::Kind kind, NodeId node, core::Line line, std::size_t byte, std::uint8_t bits) {
  if (!kept_) return;
  SoakAction action;
  action.kind = kind;
  action.node = node;
  action.second_line = line == core::Line::second;
  action.nth = leaving_[static_cast<std::size_t>(line)][node].slices;
  action.byte = static_cast<unsigned>(byte);
  action.bits = bits;
  add(action);
}

}  // namespace limb_ring::study
