// The NC behind the fold: protocol.md sections 4.9, 4.10 and 8.12.

#include "model/node.h"

namespace limb_ring::model {

namespace input = core::input;

void Node::line(const core::Input& what, Time now) {
  if (const auto* call = std::get_if<input::InputUp>(&what)) input_up(call->from, now);
  if (std::holds_alternative<input::InputLost>(what)) input_lost(now);
  if (std::holds_alternative<input::InputGap>(what)) input_gap(now);
  if (const auto* call = std::get_if<input::OutputUp>(&what)) output_up(call->to, now);
  if (std::holds_alternative<input::OutputLost>(what)) output_lost(now);
  if (const auto* call = std::get_if<input::Receive>(&what))
    receive({call->slice.kind, Bytes(call->slice.bytes.begin(), call->slice.bytes.end())}, now);
}

void Node::folded_line(const core::Input& what, Time now) {
  if (const auto* call = std::get_if<input::InputUp>(&what)) fold_->input_up(call->line, call->from, now);
  if (const auto* call = std::get_if<input::InputLost>(&what)) fold_->input_lost(call->line, now);
  if (const auto* call = std::get_if<input::InputGap>(&what)) fold_->input_gap(call->line, now);
  if (const auto* call = std::get_if<input::OutputUp>(&what)) fold_->output_up(call->line, call->to, now);
  if (const auto* call = std::get_if<input::OutputLost>(&what)) fold_->output_lost(call->line, now);
  if (const auto* call = std::get_if<input::Receive>(&what))
    fold_->receive(call->line, {call->slice.kind, Bytes(call->slice.bytes.begin(), call->slice.bytes.end())}, now);
}

void Node::lines_are(const Lines& lines, Time now) {
  const bool input_folds = lines.input_folded != in_.folded, output_folds = lines.output_folded != out_.folded;
  const bool turned_back = out_.up && lines.output_up && !out_.folded && lines.output_folded;
  if (in_.up != lines.input_up) {
    if (in_.folded && !lines.input_up) own_break_ends();
    if (lines.input_up) in_.folded = lines.input_folded;
    lines.input_up ? input_up(lines.before, now) : input_lost(now);
  }
  if (turned_back) drop_output(now);
  if (out_.up != lines.output_up) {
    if (lines.output_up) out_.folded = lines.output_folded;
    lines.output_up ? output_up(lines.next, now) : output_lost(now);
  }
  in_.neighbour = lines.before;
  out_.neighbour = lines.next;
  if (in_.folded && !lines.input_folded) own_break_ends();
  in_.folded = lines.input_folded;
  out_.folded = lines.output_folded;
  if (input_folds || output_folds) fold_changed(now);
}

/// An own half is folded, or no longer.
void Node::fold_changed(Time now) {
  watch_for_break(now);
  look_for_folds(now);
  want_beacon();
  beacons(now);
}

bool Node::takes(const Given& slice) const {
  const bool begins = slice.kind == SliceKind::start || slice.kind == SliceKind::whole;
  return !begins || insertion_bytes() + 524 <= settings_.insertion_buffer * 524;
}

/// protocol.md section 4.9: what still comes of it has passed here before the break.
bool Node::cut_off(int source) const {
  if (!fold_ || !fold_->takes_second() || !fold_->fold_node() || !configured(source)) return false;
  const unsigned away = distance(*fold_->fold_node(), source);
  return away > 0 && away < distance(*fold_->fold_node(), id());
}

// ---- what a fold changes for the node: protocol.md section 8.12 ---------------------------------------

void Node::look_for_folds(Time now) {
  if (fold_) {
    fold_known_ = in_.folded || out_.folded;
    for (const auto& [source, peer] : peers_)
      fold_known_ = fold_known_ || (peer.folds_until && *peer.folds_until >= now);
    if (fold_known_) fold_known_at_ = now;
    if (!fold_known_ && state_ != NodeState::open_chain && !break_is_own_) break_.reset();
  }
  reconsider_closed(now);
}

/// protocol.md section 4.10: two parts have grown together, or have and no new hello is said yet.
bool Node::grows_together(const Packet& home, Time now) {
  if (!falls_into_parts() || grown_together_ || hello_out_) return grown_together_;
  const bool fold_lately = fold_known_at_ && now <= *fold_known_at_ + settings_.beacon + try_timeout();
  const bool lately = settings_.several_hosts || fold_lately;
  if (!lately || ring_size_ == 0 || static_cast<unsigned>(home.hop()) <= ring_size_) return false;
  grown_together_ = new_hello_wanted_ = true;
  return true;
}

}  // namespace limb_ring::model
