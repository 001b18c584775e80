// What comes on the second line: protocol.md section 8.11.

#include "model/fold_back.h"

namespace limb_ring::model {

using wire::SliceKind;

void FoldBack::second_slice(const Given& slice, Time now) {
  if (slice.kind == SliceKind::fold) {
    const auto word = wire::fold_word({slice.kind, {slice.bytes.data(), slice.bytes.size()}});
    if (!word || !core::is_in(settings_.order, word->node)) return;
    this->word(word->kind, word->node, now);
    return decide_output(now);
  }
  if (slice.kind == SliceKind::idle || !fold_node_ || !(takes_second() || repeats())) return;
  if (!takes_second()) {
    const bool rest = slice.kind == SliceKind::more || slice.kind == SliceKind::end || slice.kind == SliceKind::abort;
    if (rest && !open_repeated_) return;
    if (!rest && slice.bytes[3] == settings_.id && slice.bytes[2] == 0) return;  // has come straight from here
  }
  if (slice.kind == SliceKind::start) open_on_second_ = true;
  if (slice.kind == SliceKind::end || slice.kind == SliceKind::abort) open_on_second_ = false;
  if (takes_second())
    nc_.slice_comes(slice, now);
  else
    repeat(slice);
  drain(now);
  decide_output(now);
}

void FoldBack::word(FoldWordKind kind, int node, Time now) {
  if (kind == FoldWordKind::deaf || kind == FoldWordKind::hears) {
    if (node != downstream_) return;
    next_is_deaf_ = kind == FoldWordKind::deaf;
    if (!next_is_deaf_ && !turned_back()) say(Line::first, FoldWordKind::last, settings_.id);
    return;
  }
  const bool bypassed = lines_[1].from && lies_between(node, settings_.id, *lines_[1].from);
  if (node == settings_.id || bypassed) return goes_round(kind, node, now);
  if (kind == FoldWordKind::begin) return begin(node, now);
  if (!folded()) put_word(Line::second, kind, node);
  if (kind == FoldWordKind::last && fold_node_ != node) return;
  break_off_second(now);
  fold_node_.reset();
  if (input_ == Half::between) input_to_first(now);
}

void FoldBack::begin(int node, Time now) {
  if (node == lines_[0].from && input_ == Half::first) say(Line::second, FoldWordKind::hears, settings_.id);
  if (fold_node_ == node && now - fold_node_heard_ < period_ / 2) return;
  if (!folded()) put_word(Line::second, FoldWordKind::begin, node);
  fold_node_ = node;
  fold_node_heard_ = now;
}

/// The fold node's timer has ended, or the second line is lost.
void FoldBack::forget_fold_node(Time now) {
  break_off_second(now);
  if (repeats()) say(Line::second, FoldWordKind::lost, settings_.id);
  fold_node_.reset();
  if (input_ == Half::between) input_to_first(now);
}

void FoldBack::break_off_second(Time now) {
  if (!open_on_second_) return;
  open_on_second_ = false;
  if (takes_second())
    nc_.input_breaks(now);
  else
    abort_repeated();
}

/// That word has come all the way round: so does what follows a `begin`.
void FoldBack::goes_round(FoldWordKind kind, int node, Time now) {
  const bool own_lost = kind == FoldWordKind::lost && node == settings_.id;
  if (fold_node_ && (own_lost || kind == FoldWordKind::begin)) forget_fold_node(now);
}

void FoldBack::repeat(const Given& slice) {
  if (slice.kind == SliceKind::start) open_repeated_ = true;
  if (slice.kind == SliceKind::end || slice.kind == SliceKind::abort) open_repeated_ = false;
  given_[1].push_back(slice);
}

void FoldBack::abort_repeated() {
  if (open_repeated_) given_[1].push_back({SliceKind::abort, {}});
  open_repeated_ = false;
}

}  // namespace limb_ring::model
