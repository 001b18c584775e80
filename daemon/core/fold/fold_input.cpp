// FoldBack's input half: the first line, the second in its place, and the way back without a loss. (ours,
// protocol.md section 8.9)
#include "core/fold/fold_back.h"

namespace limb_ring::core {

using wire::FoldWord;
using wire::FoldWordKind;
using wire::Slice;
using wire::SliceKind;

namespace {

/// Bytes of the first line that may wait while the second drains: more than a lap of largest packets of 64 nodes.
constexpr std::size_t kMostHeld = 64 * 1024;
/// Packets are held for at most 1 / kHoldShare of a try's time-out: no copy may live longer than that time-out.
constexpr int kHoldShare = 8;

}  // namespace

// When the first line is back, packets that the upstream neighbour had turned back may still be on the second line, and
// must be taken first. That neighbour says on both lines when it has stopped sending on the second.
// clang-format off
const FoldBack::InRow FoldBack::kInputTable[] = {
    // input              from                                                to            first, then
    {InInput::first_up,   in(In::first) | in(In::second) | in(In::draining),  In::draining, &FoldBack::greet_first_line,
                                                                                            &FoldBack::drain_or_take},
    {InInput::first_lost, in(In::first) | in(In::second) | in(In::draining),  In::second,   &FoldBack::leave_first_line,
                                                                                            &FoldBack::say_words},
    {InInput::through,    in(In::draining),                                   In::first,    &FoldBack::leave_second_line,
                                                                                            &FoldBack::take_first_line},
};
// clang-format on

void FoldBack::on(InInput input, Time now) {
  const InRow* row = find_row(kInputTable, input, in_);
  if (row == nullptr) return;
  (this->*row->first)(now);
  in_ = row->to;
  (this->*row->then)(now);
}

// ---- the first line is back -------------------------------------------------------------------

void FoldBack::greet_first_line(Time) {
  first_spoke_ = false;
  if (may_fold_) say(FoldWordKind::hears, id());
}

void FoldBack::drain_or_take(Time now) {
  const bool dead = fold_node_ && lines_between(*fold_node_, id()) < lines_between(from_, id());  // it is bypassed now
  if (dead) return forget_fold_node(now);
  if (!fold_node_) on(InInput::through, now);
}

void FoldBack::drain_if_settled(Time now) {
  if (in_ != In::draining || !first_spoke_) return;
  if (!waits_for_last() && !coming_second_.is_open()) return on(InInput::through, now);
  if (!timers_.runs(Timer::drain))
    timers_.start(Timer::drain, now + std::min(settings().stall, settings().send_timeout() / kHoldShare));
}

void FoldBack::leave_second_line(Time now) {
  timers_.stop(Timer::drain);
  if (coming_second_.is_open()) blocks_.input_gap(now);
  coming_second_.close();
}

// If another fold node still sends on the second line, this node repeats its packets from now on, unless it sends back
// itself.
void FoldBack::take_first_line(Time) {
  if (fold_node_ && out_ == Out::first) say(FoldWordKind::begin, *fold_node_);
}

// ---- the first line is lost -------------------------------------------------------------------

void FoldBack::leave_first_line(Time now) {
  drop_held();
  timers_.stop(Timer::drain);
  if (in_ != In::first) return;
  blocks_.input_gap(now);
  ++counters_.folds;
}

// ---- what comes in on it ------------------------------------------------------------------------

void FoldBack::receive_first(const Slice& slice, Time now) {
  if (const auto word = wire::fold_word(slice); word && word->kind == FoldWordKind::begin) return answer(*word);
  if (in_ == In::first && held_.empty() && slice.kind != SliceKind::fold) return enter(slice, now);
  first_spoke_ = true;
  if (slice.kind != SliceKind::fold) hold(slice, now);
  drain_if_settled(now);
}

// The upstream neighbour has turned back because it believes that this node hears nothing on the first line. Since its
// word has come on that line, a `hears` of this node was lost.
void FoldBack::answer(FoldWord word) {
  if (word.node == from_ && in_ == In::first) say(FoldWordKind::hears, id());
}

void FoldBack::hold(const Slice& slice, Time now) {
  if (held_.bytes() > kMostHeld) {
    drop_held();
    blocks_.input_gap(now);
  }
  held_.put(slice);
}

// Gives held slices to the blocks as fast as the insertion buffer takes them.
void FoldBack::release(Time now) {
  if (in_ != In::first) return;
  for (; !held_.empty(); held_.pop()) {
    const Slice slice = held_.front();
    const bool begins = slice.kind == SliceKind::start || slice.kind == SliceKind::whole;
    if (begins && !blocks_.has_room()) return;
    enter(slice, now);
  }
}

void FoldBack::drop_held() {
  counters_.fold_held_dropped += held_.count();
  held_.clear();
}

void FoldBack::settle_input(Time now) {
  const bool up = in_ == In::first ? input_up_ : fold_node_.has_value();
  if (up == told_input_) return;
  told_input_ = up;
  if (up)
    blocks_.input_up(from_, now, takes_second());
  else
    blocks_.input_lost(now);
}

}  // namespace limb_ring::core
