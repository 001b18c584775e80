#include "core/network_controller.h"

#include <algorithm>

namespace limb_ring::core {

NetworkController::NetworkController(const Settings& settings, Time now) : blocks_(settings) {
  if (settings.fold_back) fold_ = std::make_unique<FoldBack>(blocks_, outputs_[0], outputs_[1], ready_, now);
}

// ---- the lines ----------------------------------------------------------------------------

void NetworkController::on(const input::InputUp& up, Time now) {
  if (fold_) return fold_->tell<&FoldBack::input_up>(now, up.line, up.from);
  if (up.line == Line::first) blocks_.input_up(up.from, now);
}

void NetworkController::on(const input::InputLost& lost, Time now) {
  if (fold_) return fold_->tell<&FoldBack::input_lost>(now, lost.line);
  if (lost.line == Line::first) blocks_.input_lost(now);
}

void NetworkController::on(const input::InputGap& gap, Time now) {
  if (fold_) return fold_->tell<&FoldBack::input_gap>(now, gap.line);
  if (gap.line == Line::first) blocks_.input_gap(now);
}

void NetworkController::on(const input::OutputUp& up, Time now) {
  ready_[index(up.line)] = true;
  if (fold_) return fold_->tell<&FoldBack::output_up>(now, up.line, up.to);
  if (up.line == Line::first) blocks_.output_up(up.to, now);
}

void NetworkController::on(const input::OutputLost& lost, Time now) {
  if (fold_) return fold_->tell<&FoldBack::output_lost>(now, lost.line);
  if (lost.line == Line::first) blocks_.output_lost(now);
}

void NetworkController::receive(Line line, const wire::Slice& slice, Time now) {
  if (journal_ == nullptr) return take_in(line, slice, now);
  Input input(std::in_place_type<input::Receive>);  // made where it is seen: copies of it cost as much as recording it
  auto& call = *std::get_if<input::Receive>(&input);
  call.line = line;
  call.slice = slice;
  if (slice.kind == wire::SliceKind::whole) {
    const bool good = slice.crc_good();  // once for both, journal and relay
    call.slice.crc_checked = good;
    call.only_passes = good && blocks_.only_passes(wire::PacketFields{slice.bytes});
  }
  journal_->goes_in(input, now);
  take_in(line, call.slice, now);
}

void NetworkController::take_in(Line line, const wire::Slice& slice, Time now) {
  if (fold_) return fold_->tell<&FoldBack::receive>(now, line, slice);
  if (line == Line::first) blocks_.receive(line, slice, now);
}

// ---- time ---------------------------------------------------------------------------------

void NetworkController::on(const input::Timeout&, Time now) {
  blocks_.handle_timeout(now);
  if (fold_) fold_->tell<&FoldBack::handle_timeout>(now);
}

void NetworkController::on(const input::Run&, Time now) {
  blocks_.run(now);
  blocks_.show_given_out(output_line(), now);
  if (fold_)
    fold_->tell<&FoldBack::carry>(now, blocks_.line());
  else
    outputs_[0].take(blocks_.line());
}

Time NetworkController::next_deadline(Time now) const {
  if (has_given_out()) return now;
  const Time blocks = blocks_.next_deadline(now);
  return fold_ ? std::min(blocks, fold_->deadline()) : blocks;
}

// ---- what comes out -----------------------------------------------------------------------

bool NetworkController::take_event(Time now, Event& out) {
  const bool taken = blocks_.take_event(now, out);
  if (taken && journal_ != nullptr) journal_->taken(out, now);
  return taken;
}

bool NetworkController::take(Time now, ReceivedPacket& out) {
  const bool taken = blocks_.take(now, out);
  if (taken && journal_ != nullptr) journal_->taken(out, now);
  return taken;
}

}  // namespace limb_ring::core
