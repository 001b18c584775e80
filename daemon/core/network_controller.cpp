#include "core/network_controller.h"

#include <algorithm>

namespace limb_ring::core {

NetworkController::NetworkController(const Settings& settings, Time now) : Blocks(settings) {
  Blocks& blocks = *this;
  if (settings.fold_back) fold_.emplace(blocks, outputs_[0], outputs_[1], now);
}

// ---- the lines ----------------------------------------------------------------------------

void NetworkController::input_up(Line line, NodeId from, Time now) {
  if (fold_) return fold_->tell<&FoldBack::input_up>(now, line, from);
  if (line == Line::first) Blocks::input_up(from, now);
}

void NetworkController::input_lost(Line line, Time now) {
  if (fold_) return fold_->tell<&FoldBack::input_lost>(now, line);
  if (line == Line::first) Blocks::input_lost(now);
}

void NetworkController::input_gap(Line line, Time now) {
  if (fold_) return fold_->tell<&FoldBack::input_gap>(now, line);
  if (line == Line::first) Blocks::input_gap(now);
}

void NetworkController::output_up(Line line, NodeId to, Time now) {
  ready_[index(line)] = true;
  if (fold_) return fold_->tell<&FoldBack::output_up>(now, line, to);
  if (line == Line::first) Blocks::output_up(to, now);
}

void NetworkController::output_lost(Line line, Time now) {
  if (fold_) return fold_->tell<&FoldBack::output_lost>(now, line);
  if (line == Line::first) Blocks::output_lost(now);
}

void NetworkController::set_output_ready(Line line, bool ready) {
  ready_[index(line)] = ready;
  update_ready();
}

void NetworkController::receive(Line line, const wire::Slice& slice, Time now) {
  if (fold_) return fold_->tell<&FoldBack::receive>(now, line, slice);
  if (line == Line::first) enter(slice, now);
}

void NetworkController::enter(const wire::Slice& slice, Time now) {
  if (tap_ == nullptr) return Blocks::receive(slice, now);
  const Line line = input_line();
  tap_->arrives(slice, line, now);
  Blocks::receive(slice, now);
  tap_->has_arrived(slice, line, now);
}

// ---- time ---------------------------------------------------------------------------------

void NetworkController::handle_timeout(Time now) {
  Blocks::handle_timeout(now);
  if (fold_) fold_->tell<&FoldBack::handle_timeout>(now);
}

void NetworkController::run(Time now) {
  Blocks::run(now);
  wire::SliceWriter& given_out = Blocks::line();
  if (tap_ != nullptr && !given_out.empty()) tap_->leaves(given_out.view(), output_line(), now);
  if (fold_)
    fold_->tell<&FoldBack::carry>(now, given_out);
  else
    outputs_[0].take(given_out);
  update_ready();
}

Time NetworkController::next_deadline(Time now) const {
  if (has_given_out()) return now;
  const Time blocks = Blocks::next_deadline(now);
  return fold_ ? std::min(blocks, fold_->deadline()) : blocks;
}

}  // namespace limb_ring::core
