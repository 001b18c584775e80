#include "core/fold/fold_back.h"

namespace limb_ring::core {

FoldBack::FoldBack(Blocks& blocks, wire::SliceWriter& first, wire::SliceWriter& second,
                   const std::array<bool, 2>& ready, Time now)
    : blocks_(blocks),
      counters_(blocks.counters()),
      first_(first),
      second_(second),
      ready_(ready),
      from_(neighbour(blocks.settings().order.size() - 1)),
      to_(neighbour(1)),
      second_from_(to_) {
  timers_.start(Timer::permission, now + blocks.settings().fold_permission);
}

// ---- the lines ------------------------------------------------------------------------------

void FoldBack::input_up(Line line, NodeId from, Time now) {
  if (line == Line::second) {
    second_from_ = from;
    return;
  }
  input_up_ = true;
  from_ = from;
  on(InInput::first_up, now);
}

void FoldBack::input_lost(Line line, Time now) {
  if (line == Line::second) return lose_second_input(now);
  if (!input_up_) return;
  input_up_ = false;
  on(InInput::first_lost, now);
}

void FoldBack::input_gap(Line line, Time now) {
  if (line == Line::second) return break_off_second(now);
  if (in_ == In::first) blocks_.input_gap(now);
}

void FoldBack::output_up(Line line, NodeId to, Time now) {
  if (line == Line::second) {
    second_output_up_ = true;
    repeated_.close();
    if (fold_node_ && repeats()) say(wire::FoldWordKind::begin, *fold_node_);
    say_words(now);
  } else {
    output_up_ = true;
    to_ = to;
    next_is_deaf_ = false;
    greet_next_node();
  }
}

void FoldBack::output_lost(Line line, Time) { (line == Line::first ? output_up_ : second_output_up_) = false; }

void FoldBack::receive(Line line, const wire::Slice& slice, Time now) {
  if (slice.kind == wire::SliceKind::idle) return;
  if (line == Line::first)
    receive_first(slice, now);
  else
    receive_second(slice, now);
}

void FoldBack::carry(wire::SliceWriter& given_out, Time) {
  wire::each_slice(given_out.view(), [this](const wire::Slice& slice) { given_out_.see(slice); });
  (out_ == Out::first ? first_ : second_).take(given_out);
}

// ---- both halves ------------------------------------------------------------------------------

void FoldBack::settle(Time now) {
  if (!may_fold_ && input_up_ && output_up_) permit_folding(now);
  settle_input(now);
  settle_output(now);
  if (!repeats()) stop_repeating();
  tell_neighbours();
  blocks_.set_turned_back_at(takes_second() ? fold_node_ : std::nullopt);
  blocks_.set_folded(takes_second(), turned_back() && told_output_, now);
  blocks_.set_output_ready(ready_[turned_back() ? 1 : 0]);  // another line may stand for the output from now on
  release(now);
}

// A half may be folded already: the next node can be deaf before.
void FoldBack::permit_folding(Time now) {
  may_fold_ = true;
  timers_.stop(Timer::permission);
  say_words(now);
}

// While the output is turned back, no node counts as bypassed by it; orphans are discarded by their HOP alone.
void FoldBack::tell_neighbours() { blocks_.set_neighbours(from_, to_, out_ == Out::first ? to_ : neighbour(1)); }

// Words can be lost with the link, so a node that has folded repeats them.
void FoldBack::say_words(Time now) {
  using wire::FoldWordKind;
  timers_.stop(Timer::words);
  if (!may_fold_) return;
  if (in_ == In::second) say(FoldWordKind::deaf, id());
  if (in_ == In::draining) say(FoldWordKind::hears, id());
  if (out_ != Out::first) say(FoldWordKind::begin, id());
  if (next_is_deaf_ && output_up_) wire::put(first_, {FoldWordKind::begin, id()});
  if (in_ == In::first && out_ == Out::first) return;
  timers_.start(Timer::words, now + repeat_period());
}

Duration FoldBack::repeat_period() const {
  const Duration beacon = settings().beacon;
  return beacon.count() != 0 ? beacon : Duration{std::chrono::milliseconds(100)};
}

void FoldBack::handle_timeout(Time now) {
  if (timers_.due(Timer::permission, now)) permit_folding(now);
  if (timers_.due(Timer::words, now)) say_words(now);
  if (timers_.due(Timer::drain, now)) {
    if (waits_for_last())
      forget_fold_node(now);
    else
      on(InInput::through, now);
  }
  if (timers_.due(Timer::fold_node, now)) lose_second_input(now);
}

}  // namespace limb_ring::core
