// FoldBack's second line: what the nodes tell each other on it, and what is repeated.
#include "core/fold/fold_back.h"

namespace limb_ring::core {

using wire::FoldMark;
using wire::FoldWord;
using wire::Slice;
using wire::SliceKind;

namespace {

/// What may wait to be repeated: more than a lap of largest packets of 254 nodes. Nobody strips on the second line,
/// so if words are lost and lines duplicate packets, their number could grow until the fold node (tail) is forgotten.
constexpr std::size_t kMostRepeated = 256 * 1024;

}  // namespace

void FoldBack::second_input_lost(Time now) { lose_tail(now); }

void FoldBack::lose_tail(Time now) {
  break_off_second(now);
  if (tail_ && repeats()) say(FoldMark::lost, id());
  forget_tail(now);
}

void FoldBack::second_input_gap(Time now) { break_off_second(now); }

void FoldBack::second_output_up(Time now) {
  second_output_up_ = true;
  if (tail_ && repeats()) say(FoldMark::begin, *tail_);
  say_again(now);
  settle(now);
}

void FoldBack::second_output_lost(Time now) {
  second_output_up_ = false;
  settle(now);
}

void FoldBack::receive_second(const Slice& slice, Time now) {
  if (slice.kind == SliceKind::idle) return;
  if (const auto word = wire::fold_word(slice); word && place_of(blocks_.settings(), word->node) < blocks_.settings().nodes())
    return hear(*word, slice, now);
  const bool takes = in_ != In::first;
  const bool repeated = repeats() && tail_ && second_.view().size < kMostRepeated;
  const bool wanted = slice.kind != SliceKind::fold && (takes || repeated);
  if (!wanted) {
    ++counters_.fold_discarded;
    return;
  }
  second_open_ = open_after(slice, second_open_);
  if (!takes) return second_.put(slice.kind, slice.bytes);
  blocks_.enter(slice, now);
  drain_if_settled(now);
}

// What was coming in on the second line will never be whole.
void FoldBack::break_off_second(Time now) {
  if (!second_open_) return;
  second_open_ = false;
  if (in_ != In::first)
    blocks_.input_gap(now);
  else
    second_.put(SliceKind::abort, {});
}

void FoldBack::hear(FoldWord word, const Slice& slice, Time now) {
  const bool of_neighbour = word.mark == FoldMark::deaf || word.mark == FoldMark::hears;
  if (!of_neighbour) return hear_of_tail(word, slice, now);
  if (word.node != to_) return;  // of a node that is bypassed
  next_is_deaf_ = word.mark == FoldMark::deaf;
  if (!next_is_deaf_) greet_on_first();
  settle(now);
}

// The node of the word lies between this node and the one that sends to it on the second line: it is bypassed there, so
// its word has gone all the way round, and nobody else takes it off.
bool FoldBack::has_come_round(FoldWord word) const {
  const Settings& settings = blocks_.settings();
  const std::size_t nodes = settings.order.size();
  const auto ahead = [&](NodeId node) { return (place_of(settings, node) + nodes - place_of(settings, id())) % nodes; };
  return ahead(word.node) != 0 && ahead(word.node) < ahead(second_from_);
}

// A word that comes back to the node that said it was repeated by all: no node is behind a break. If this node has said
// `begin` since its `lost`, it says `lost` once more: otherwise nobody would take what is on the second line.
void FoldBack::hear_of_tail(FoldWord word, const Slice& slice, Time now) {
  if (word.node == id()) return word.mark == FoldMark::lost && tail_ ? lose_tail(now) : void();
  if (has_come_round(word)) return;
  // The node before still sends back what this one would hear: a `hears` was lost.
  if (word.mark == FoldMark::begin && word.node == from_ && in_ == In::first) say(FoldMark::hears, id());
  const bool said_just_now = word.mark == FoldMark::begin && tail_ == word.node &&
                             tail_due_ - now > kMissedBeacons * pause() - pause() / 2;
  if (said_just_now) return;  // it has come round: no node is behind a break
  if (repeats()) second_.put(slice.kind, slice.bytes);
  if (word.mark == FoldMark::begin) {
    tail_ = word.node;
    tail_due_ = now + kMissedBeacons * pause();
    return settle(now);
  }
  if (word.mark == FoldMark::last && tail_ != word.node) return;
  break_off_second(now);
  forget_tail(now);
}

void FoldBack::forget_tail(Time now) {
  tail_.reset();
  tail_due_ = kNever;
  if (in_ == In::draining) drained(now);
  settle(now);
}

}  // namespace limb_ring::core
