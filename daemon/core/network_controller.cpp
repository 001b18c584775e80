#include "core/network_controller.h"

#include <algorithm>

namespace limb_ring::core {

NetworkController::NetworkController(const Settings& settings, Time now) : Blocks(settings) {
  Blocks& blocks = *this;
  if (settings.fold_back) fold_ = std::make_unique<FoldBack>(blocks, outputs_[0], outputs_[1], now);
}

// ---- the lines ----------------------------------------------------------------------------

void NetworkController::input_up(Line line, NodeId from, Time now) {
  note(input::InputUp{line, from}, now);
  if (fold_) return fold_->tell<&FoldBack::input_up>(now, line, from);
  if (line == Line::first) Blocks::input_up(from, now);
}

void NetworkController::input_lost(Line line, Time now) {
  note(input::InputLost{line}, now);
  if (fold_) return fold_->tell<&FoldBack::input_lost>(now, line);
  if (line == Line::first) Blocks::input_lost(now);
}

void NetworkController::input_gap(Line line, Time now) {
  note(input::InputGap{line}, now);
  if (fold_) return fold_->tell<&FoldBack::input_gap>(now, line);
  if (line == Line::first) Blocks::input_gap(now);
}

void NetworkController::output_up(Line line, NodeId to, Time now) {
  note(input::OutputUp{line, to}, now);
  ready_[index(line)] = true;
  if (fold_) return fold_->tell<&FoldBack::output_up>(now, line, to);
  if (line == Line::first) Blocks::output_up(to, now);
}

void NetworkController::output_lost(Line line, Time now) {
  note(input::OutputLost{line}, now);
  if (fold_) return fold_->tell<&FoldBack::output_lost>(now, line);
  if (line == Line::first) Blocks::output_lost(now);
}

void NetworkController::set_output_ready(Line line, bool ready) {
  if (ready_[index(line)] == ready) return;
  note(input::OutputReady{line, ready}, kNever);
  ready_[index(line)] = ready;
  update_ready();
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
    call.only_passes = good && only_passes(wire::PacketFields{slice.bytes});
  }
  journal_->goes_in(input, now);
  take_in(line, call.slice, now);
}

void NetworkController::take_in(Line line, const wire::Slice& slice, Time now) {
  if (fold_) return fold_->tell<&FoldBack::receive>(now, line, slice);
  if (line == Line::first) enter(slice, now);
}

void NetworkController::enter(const wire::Slice& slice, Time now) {
  if (tap_ != nullptr) tap_->arrives(slice, input_line(), now);
  Blocks::receive(slice, now);
}

// ---- the CPU and its helpers --------------------------------------------------------------

void NetworkController::send(const SendRequest& request, Time now) {
  note(input::Send{request}, now);
  Blocks::send(request, now);
}

void NetworkController::interrupt(const InterruptRequest& request, Time now) {
  note(input::Interrupt{request}, now);
  Blocks::interrupt(request, now);
}

void NetworkController::pull(Owner owner, std::uint32_t token, unsigned input, Time now) {
  note(input::Pull{owner, token, input}, now);
  Blocks::pull(owner, token, input, now);
}

void NetworkController::cancel(Owner owner, Time now) {
  note(input::Cancel{owner}, now);
  Blocks::cancel(owner, now);
}

void NetworkController::set_cpu_present(bool present) {
  note(input::CpuPresent{present}, kNever);
  Blocks::set_cpu_present(present);
}

void NetworkController::set_cpu(const CpuReport& report, Time now) {
  note(input::Cpu{report}, now);
  Blocks::set_cpu(report, now);
}

void NetworkController::cpu_reset(Owner cpu, Time now) {
  note(input::CpuReset{cpu}, now);
  Blocks::cpu_reset(cpu, now);
}

bool NetworkController::take(Time now, ReceivedPacket& out) {
  const bool taken = Blocks::take(now, out);
  if (taken && journal_ != nullptr) journal_->taken(out, now);
  return taken;
}

bool NetworkController::take_event(Time now, Event& out) {
  const bool taken = Blocks::take_event(now, out);
  if (taken && journal_ != nullptr) journal_->taken(out, now);
  return taken;
}

// ---- time ---------------------------------------------------------------------------------

void NetworkController::handle_timeout(Time now) {
  note(input::Timeout{}, now);
  Blocks::handle_timeout(now);
  if (fold_) fold_->tell<&FoldBack::handle_timeout>(now);
}

void NetworkController::run(Time now) {
  note(input::Run{}, now);
  update_ready();  // another line may stand for the output since
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
