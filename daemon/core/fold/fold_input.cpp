// FoldBack's input: the first line, the second in its place, and the way back without a loss.
#include "core/fold/fold_back.h"

namespace limb_ring::core {

using wire::FoldMark;
using wire::FoldWord;
using wire::Slice;
using wire::SliceKind;

namespace {

/// How much of the first line may wait while the second drains: more than a lap of largest packets of 64 nodes.
constexpr std::size_t kMostHeld = 64 * 1024;
/// Packets may be held for this part of a try's time-out: no copy may live longer than that time-out.
constexpr int kHoldShare = 8;

bool begins_data(const Slice& slice) { return slice.kind == SliceKind::start || slice.kind == SliceKind::whole; }

/// How many lines lie between a node and this one, in ring order.
std::size_t distance(const Settings& settings, NodeId from) {
  const std::size_t nodes = settings.order.size();
  return (place_of(settings, settings.id) + nodes - place_of(settings, from)) % nodes;
}

}  // namespace

// What the node before has turned back is still on its way on the second line and must be taken first. That node says
// on both lines when it has stopped sending on the second.
void FoldBack::begin_draining(Time now) {
  first_spoke_ = false;
  if (may_fold_) say(FoldMark::hears, id());
  if (in_ == In::first) return;
  in_ = In::draining;
  const Settings& settings = blocks_.settings();
  const bool dead = tail_ && distance(settings, *tail_) < distance(settings, from_);  // the fold node is bypassed now
  if (dead) return forget_tail(now);
  if (!tail_) drained(now);
}

void FoldBack::drain_if_settled(Time now) {
  if (in_ != In::draining || !first_spoke_) return;
  if (!waits_for_last() && !second_open_) return drained(now);
  const Settings& settings = blocks_.settings();
  if (drain_due_ == kNever) drain_due_ = now + std::min(settings.stall, settings.send_timeout() / kHoldShare);
}

// Back to the first line. If another fold still sends on the second one, this node repeats that from now on.
void FoldBack::drained(Time now) {
  in_ = In::first;
  drain_due_ = kNever;
  if (second_open_) blocks_.input_gap(now);
  second_open_ = false;
  if (tail_ && waits_for_last()) {
    tail_.reset();
    tail_due_ = kNever;
  }
  if (tail_) say(FoldMark::begin, *tail_);
  tell_turned_back();
  release(now);
}

void FoldBack::hold(const Slice& slice, Time now) {
  if (held_.view().size > kMostHeld) {
    drop_held();
    blocks_.input_gap(now);
  }
  held_.put(slice.kind, slice.bytes);
  if (in_ == In::first) release(now);
}

// As fast as the insertion buffer takes it.
void FoldBack::release(Time now) {
  if (in_ != In::first) return;
  while (released_ < held_.view().size) {
    const wire::SliceParse parse = wire::parse_slice(held_.view().from(released_));
    if (begins_data(parse.slice) && !blocks_.has_room()) return;
    released_ += parse.consumed;
    blocks_.enter(parse.slice, now);
  }
  held_.clear();
  released_ = 0;
}

void FoldBack::drop_held() {
  while (released_ < held_.view().size) {
    released_ += wire::parse_slice(held_.view().from(released_)).consumed;
    ++counters_.fold_held_dropped;
  }
  held_.clear();
  released_ = 0;
}

void FoldBack::settle_input(Time now) {
  const bool up = in_ == In::first ? input_up_ : tail_.has_value();
  if (up == told_input_) return;
  told_input_ = up;
  if (up)
    blocks_.input_up(from_, now);
  else
    blocks_.input_lost(now);
}

}  // namespace limb_ring::core
