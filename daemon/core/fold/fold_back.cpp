#include "core/fold/fold_back.h"

namespace limb_ring::core {

using wire::FoldMark;
using wire::FoldWord;
using wire::Slice;
using wire::SliceKind;

namespace {

NodeId neighbour(const Settings& settings, std::size_t steps) {
  return settings.order[(place_of(settings, settings.id) + steps) % settings.order.size()];
}

}  // namespace

FoldBack::FoldBack(Blocks& blocks, wire::SliceWriter& first, wire::SliceWriter& second, Time now)
    : blocks_(blocks),
      counters_(blocks.counters()),
      first_(first),
      second_(second),
      from_(neighbour(blocks.settings(), blocks.settings().order.size() - 1)),
      to_(neighbour(blocks.settings(), 1)),
      second_from_(to_),
      patience_(now + blocks.settings().break_grace) {}

// ---- the first line -----------------------------------------------------------------------

void FoldBack::input_up(NodeId from, Time now) {
  if (input_up_) input_lost(now);
  input_up_ = true;
  from_ = from;
  tell_neighbours();
  begin_draining(now);
  settle(now);
}

void FoldBack::input_lost(Time now) {
  if (!input_up_) return;
  input_up_ = false;
  drop_held();
  if (in_ == In::first) {
    blocks_.input_gap(now);
    ++counters_.folds;
  }
  in_ = In::second;
  drain_due_ = kNever;
  say_again(now);
  settle(now);
}

void FoldBack::input_gap(Time now) {
  if (in_ == In::first) blocks_.input_gap(now);
}

void FoldBack::output_up(NodeId to, Time now) {
  if (output_up_) output_lost(now);
  output_up_ = true;
  to_ = to;
  tell_neighbours();
  next_is_deaf_ = false;
  greet_on_first();
  settle(now);
}

void FoldBack::output_lost(Time now) {
  if (!output_up_) return;
  output_up_ = false;
  settle(now);
}

void FoldBack::receive(const Slice& slice, Time now) {
  if (slice.kind == SliceKind::idle) return;
  if (const auto word = wire::fold_word(slice); word && word->mark == FoldMark::begin) return answer(*word);
  if (in_ == In::first && held_.empty() && slice.kind != SliceKind::fold) return blocks_.enter(slice, now);
  first_spoke_ = true;
  if (slice.kind != SliceKind::fold) hold(slice, now);
  drain_if_settled(now);
}

// The node before has turned back because it believes that this one hears nothing on the first line. Its word has come
// on that line: a `hears` was lost.
void FoldBack::answer(FoldWord word) {
  if (word.node == from_ && in_ == In::first) say(FoldMark::hears, id());
}

// ---- output: first or second line ---------------------------------------------------------

void FoldBack::settle_output(Time now) {
  const bool back = (!output_up_ && may_fold_) || next_is_deaf_;
  if (back && out_ != Out::second) turn_back(now);
  if (!back && out_ == Out::second) out_ = Out::leaving;
  if (out_ == Out::leaving && !second_output_up_) {
    blocks_.output_replaced(now);
    out_open_ = false;
  }
  if (out_ == Out::leaving && !out_open_) back_to_first();
  const bool up = out_ == Out::first ? output_up_ : second_output_up_ && told_input_;
  if (up == told_output_) return;
  told_output_ = up;
  if (up)
    blocks_.output_up(to_, now);
  else
    blocks_.output_lost(now);
}

void FoldBack::turn_back(Time now) {
  const bool anew = out_ == Out::first;
  out_ = Out::second;
  if (!anew) return;
  ++counters_.folds;
  out_open_ = false;
  tell_neighbours();
  if (told_output_) blocks_.output_replaced(now);
  say_again(now);
}

// Between two packets, so that none is lost.
void FoldBack::back_to_first() {
  out_ = Out::first;
  tell_neighbours();
  say(FoldMark::last, id());
  greet_on_first();
  if (tail_ && in_ == In::first) say(FoldMark::begin, *tail_);
}

// While the output is turned back, no node counts as bypassed by it; orphans are discarded by their HOP alone.
void FoldBack::tell_neighbours() {
  blocks_.set_neighbours(from_, to_, out_ == Out::first ? to_ : neighbour(blocks_.settings(), 1));
}

// The next node waits for this before it takes the first line for its input.
void FoldBack::greet_on_first() {
  if (out_ == Out::first) wire::put(first_, {FoldMark::last, id()});
}

bool FoldBack::open_after(const Slice& slice, bool open) {
  if (slice.kind == SliceKind::start) return true;
  return open && (slice.kind == SliceKind::more || slice.kind == SliceKind::interrupt);
}

void FoldBack::put_out(const Slice& slice) {
  (out_ == Out::first ? first_ : second_).put(slice.kind, slice.bytes);
  out_open_ = open_after(slice, out_open_);
  if (out_ == Out::leaving && !out_open_) back_to_first();
}

void FoldBack::carry(wire::SliceWriter& line, Time now) {
  if (out_ == Out::first && first_.empty()) {
    first_.swap(line);
  } else {
    wire::ByteView rest = line.view();
    while (!rest.empty()) {
      const wire::SliceParse parse = wire::parse_slice(rest);
      put_out(parse.slice);
      rest = rest.from(parse.consumed);
    }
  }
  line.clear();
  tell_folded(now);
}

// ---- time ---------------------------------------------------------------------------------

void FoldBack::settle(Time now) {
  if (input_up_ && output_up_) may_fold_ = true;
  if (may_fold_) patience_ = kNever;
  settle_input(now);
  settle_output(now);
  tell_turned_back();
  tell_folded(now);
}

// Words can be lost with the link, so a node that has folded repeats them.
void FoldBack::say_again(Time now) {
  say_again_ = kNever;
  if (!may_fold_) return;
  if (in_ == In::second) say(FoldMark::deaf, id());
  if (in_ == In::draining) say(FoldMark::hears, id());
  if (out_ != Out::first) say(FoldMark::begin, id());
  if (next_is_deaf_ && output_up_) wire::put(first_, {FoldMark::begin, id()});
  if (in_ == In::first && out_ == Out::first) return;
  say_again_ = now + pause();
}

Duration FoldBack::pause() const {
  const Duration beacon = blocks_.settings().beacon;
  return beacon.count() != 0 ? beacon : Duration{std::chrono::milliseconds(100)};
}

void FoldBack::handle_timeout(Time now) {
  if (patience_ <= now) {
    may_fold_ = true;
    say_again(now);
    settle(now);
  }
  if (say_again_ <= now) say_again(now);
  if (drain_due_ <= now) waits_for_last() ? forget_tail(now) : drained(now);
  if (tail_due_ <= now) lose_tail(now);
  release(now);
}

}  // namespace limb_ring::core
