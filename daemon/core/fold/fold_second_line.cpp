// What passes on the second line: words of the nodes, and packets that are repeated. (ours, protocol.md sections 8.8
// and 8.11)
#include "core/fold/fold_back.h"

namespace limb_ring::core {

using wire::FoldWord;
using wire::FoldWordKind;
using wire::Slice;
using wire::SliceKind;

namespace {

/// Bytes that may wait to be repeated: more than a lap of largest packets of 254 nodes. Nobody takes packets off that
/// line, so if words are lost and lines duplicate packets, their number could grow until the fold node is forgotten.
constexpr std::size_t kMostRepeated = 256 * 1024;

}  // namespace

void FoldBack::receive_second(const Slice& slice, Time now) {
  if (const auto word = wire::fold_word(slice); word && is_in(settings().order, word->node))
    return hear(*word, slice, now);
  const bool takes = in_ != In::first;
  const bool wanted = slice.kind != SliceKind::fold && fold_node_ && (takes || may_repeat(slice));
  if (!wanted) {
    ++counters_.fold_discarded;
    return;
  }
  coming_second_.see(slice);
  if (!takes) return repeat(slice);
  enter(slice, now);
  drain_if_settled(now);
}

// With HOP 0 an own packet has come straight from this node, which sent it back, all the way round. What goes on a DATP
// whose start was not repeated is not repeated either.
bool FoldBack::may_repeat(const Slice& slice) const {
  if (!repeats() || second_.view().size >= kMostRepeated) return false;
  if (goes_on_datp(slice.kind)) return repeated_.is_open();
  return slice.bytes[wire::field::kSource] != id() || slice.bytes[wire::field::kHop] != 0;
}

void FoldBack::repeat(const Slice& slice) {
  repeated_.see(slice);
  second_.put(slice.kind, slice.bytes);
}

// Nobody repeats the rest of it.
void FoldBack::stop_repeating() {
  if (!repeated_.is_open()) return;
  repeated_.close();
  second_.put(SliceKind::abort, {});
}

void FoldBack::say(FoldWordKind kind, NodeId node) {
  const bool neighbours = kind == FoldWordKind::deaf || kind == FoldWordKind::hears;
  if (!neighbours) stop_repeating();
  wire::put(second_, {kind, node});
}

// What was coming in on the second line will never be whole.
void FoldBack::break_off_second(Time now) {
  if (!coming_second_.is_open()) return;
  coming_second_.close();
  if (in_ != In::first) blocks_.input_gap(now);
  stop_repeating();
}

void FoldBack::hear(FoldWord word, const Slice& slice, Time now) {
  const bool of_neighbour = word.kind == FoldWordKind::deaf || word.kind == FoldWordKind::hears;
  if (!of_neighbour) return hear_of_fold_node(word, slice, now);
  if (word.node != to_) return;  // of a node that is bypassed
  next_is_deaf_ = word.kind == FoldWordKind::deaf;
  if (!next_is_deaf_) greet_next_node();
}

// The node of the word lies between this node and the one that sends to this node on the second line. It is bypassed
// there, so its word has gone all the way round, and nobody else takes it off.
bool FoldBack::has_come_round(FoldWord word) const {
  const std::size_t ahead = lines_between(id(), word.node);
  return ahead != 0 && ahead < lines_between(id(), second_from_);
}

void FoldBack::hear_of_fold_node(FoldWord word, const Slice& slice, Time now) {
  if (word.node == id() || has_come_round(word)) return end_what_has_come_round(word, now);
  // The upstream neighbour still sends back, although this node hears the first line: a `hears` was lost.
  if (word.kind == FoldWordKind::begin && word.node == from_ && in_ == In::first) say(FoldWordKind::hears, id());
  const bool said_just_now =
      word.kind == FoldWordKind::begin && fold_node_ == word.node &&
      timers_[Timer::fold_node] - now > wire::kMissedBeacons * repeat_period() - repeat_period() / 2;
  if (said_just_now) return;  // it has come round: no node is behind a break
  if (repeats()) second_.put(slice.kind, slice.bytes);
  if (word.kind == FoldWordKind::begin) {
    fold_node_ = word.node;
    timers_.start(Timer::fold_node, now + wire::kMissedBeacons * repeat_period());
    return;
  }
  if (word.kind == FoldWordKind::last && fold_node_ != word.node) return;
  break_off_second(now);
  forget_fold_node(now);
}

// All others have repeated this own word, or that of a bypassed node, so no node is behind a break. What follows a
// `begin` has been here before. If it is an own `lost`, and this node knows a fold node again (it has said `begin`
// since), it says `lost` once more: nobody would take packets off the second line.
void FoldBack::end_what_has_come_round(FoldWord word, Time now) {
  const bool lost = word.kind == FoldWordKind::lost && word.node == id();
  if ((lost || word.kind == FoldWordKind::begin) && fold_node_) lose_second_input(now);
}

void FoldBack::forget_fold_node(Time now) {
  fold_node_.reset();
  timers_.stop(Timer::fold_node);
  on(InInput::through, now);
}

// Nothing more comes on the second line.
void FoldBack::lose_second_input(Time now) {
  break_off_second(now);
  if (fold_node_ && repeats()) say(FoldWordKind::lost, id());
  forget_fold_node(now);
}

}  // namespace limb_ring::core
