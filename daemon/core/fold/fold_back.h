#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/blocks.h"
#include "core/line.h"
#include "core/state_table.h"
#include "core/timers.h"
#include "wire/control_message.h"
#include "wire/slice.h"

namespace limb_ring::core {

/// Slices of the first line that wait until the second has drained, in their order, and then until there is room.
class HeldSlices {
 public:
  bool empty() const { return first_ == slices_.size(); }
  /// Bytes of those that are in.
  std::size_t bytes() const { return bytes_.size() - popped_bytes(); }
  void put(const wire::Slice& slice) {
    if (popped_bytes() > bytes()) forget_popped();
    slices_.push_back({slice.kind, bytes_.size(), slice.bytes.size});
    bytes_.insert(bytes_.end(), slice.bytes.begin(), slice.bytes.end());
  }
  /// Valid until the next put(). @pre !empty()
  wire::Slice front() const {
    const Held& held = slices_[first_];
    return {held.kind, wire::ByteView{bytes_.data(), bytes_.size()}.from(held.at).first(held.size)};
  }
  void pop() {
    ++first_;
    if (empty()) clear();
  }
  /// How many are in.
  std::size_t count() const { return slices_.size() - first_; }
  void clear() {
    slices_.clear();
    bytes_.clear();
    first_ = 0;
  }

  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    forget_popped();
    a("slices", slices_)("bytes", bytes_);
  }

 private:
  struct Held {
    wire::SliceKind kind;
    std::size_t at, size;  ///< in bytes_
    template <class Archive>
    void archive(Archive& a) {
      a("kind", kind)("at", at)("size", size);
    }
  };
  std::size_t popped_bytes() const { return empty() ? 0 : slices_[first_].at; }
  // Under load it may never be empty, and must not grow.
  void forget_popped() {
    const std::size_t popped = popped_bytes();
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(popped));
    slices_.erase(slices_.begin(), slices_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
    for (Held& held : slices_) held.at -= popped;
  }

  std::vector<Held> slices_;
  std::vector<std::uint8_t> bytes_;
  std::size_t first_ = 0;
};

/// Whether a DATP is under way on a line, from the slices that pass.
class OpenPacket {
 public:
  bool is_open() const { return open_; }
  void see(const wire::Slice& slice) {
    const bool inside = slice.kind == wire::SliceKind::more || slice.kind == wire::SliceKind::interrupt;
    open_ = slice.kind == wire::SliceKind::start || (open_ && inside);
  }
  void close() { open_ = false; }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("open", open_);
  }

 private:
  bool open_ = false;
};

/// Fold-back around a break, with a second, counter-rotating line. (ours, protocol.md sections 8.7 to 8.12; Honda's
/// own answer is switches to a redundant line, US10742444)
///
/// It stands between a node's four lines and its blocks. The node before a break, the fold node, turns its output back
/// onto the second line. The node behind the break takes the second line for its input; all others only repeat what
/// comes on it. So the blocks see each packet once, in ring order:
///
///     first line     a -> b    c -> d -> a          the line from b to c is broken
///     second line    a <- b    c <- d <- a          b turns back, a and d repeat, c takes
///
/// Each half, input and output, is a state machine with a table of its own (fold_input.cpp, fold_output.cpp). Like
/// Blocks it takes bytes and the time, and gives bytes and a deadline. Call carry() after Blocks::run().
class FoldBack {
 public:
  /// All must outlive this. @pre blocks.settings().fold_back
  /// @param first,second what goes onto the lines; whoever writes them clears them
  /// @param ready which of the two lines takes something now
  FoldBack(Blocks& blocks, wire::SliceWriter& first, wire::SliceWriter& second, const std::array<bool, 2>& ready,
           Time now);
  FoldBack(const FoldBack&) = delete;
  FoldBack& operator=(const FoldBack&) = delete;

  /// Calls one of the inputs below, as in tell<&FoldBack::receive>(now, line, slice), then settles what follows from
  /// it. That is done here and nowhere else.
  template <auto input, class... What>
  void tell(Time now, What&&... what) {
    (this->*input)(what..., now);
    settle(now);
  }

  /// @name Inputs, for tell()
  /// The second line comes in from the next node, and goes out to the one before. An input that is up does not mean
  /// that there is a fold; words and packets on it do.
  ///@{
  void input_up(Line line, NodeId from, Time now);
  void input_lost(Line line, Time now);
  void input_gap(Line line, Time now);
  void output_up(Line line, NodeId to, Time now);
  void output_lost(Line line, Time now);
  void receive(Line line, const wire::Slice& slice, Time now);
  /// Puts what the blocks have given out onto the line that stands for their output; leaves it empty.
  void carry(wire::SliceWriter& given_out, Time now);
  void handle_timeout(Time now);
  ///@}

  /// The output goes onto the second line.
  bool turned_back() const { return out_ != Out::first; }
  /// The second line stands for the input.
  bool takes_second() const { return in_ != In::first && fold_node_; }
  /// What comes in on the second line is for the NC, also while no fold node is known.
  bool hears_second() const { return in_ != In::first; }

  /// What came in on the first line waits until the second has drained.
  bool holds_slices() const { return !held_.empty(); }

  Time deadline() const { return timers_.next(); }

  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("input_up", input_up_)("output_up", output_up_)("from", from_)("to", to_)("second_from", second_from_);
    a("second_output_up", second_output_up_)("in", in_)("held", held_)("first_spoke", first_spoke_);
    a("told_input", told_input_)("out", out_)("next_is_deaf", next_is_deaf_);
    a("told_output", told_output_)("fold_node", fold_node_);
    a("coming_second", coming_second_)("repeated", repeated_)("given_out", given_out_);
    a("may_fold", may_fold_)("timers", timers_);
  }

 private:
  /// draining: the first line is back, but what is still on the second must be taken first.
  enum class In : std::uint8_t { first, second, draining };
  enum class InInput : std::uint8_t {
    first_up,
    first_lost,
    through  ///< nothing more comes on the second line, no fold node is known, or the drain timer has ended
  };
  using InRow = Transition<FoldBack, InInput, In>;
  static const InRow kInputTable[];
  void on(InInput input, Time now);

  /// leaving: the first line is back, and a packet is still going out on the second.
  enum class Out : std::uint8_t { first, second, leaving };
  enum class OutInput : std::uint8_t {
    blocked,  ///< the first line is down, or the next node hears nothing on it
    free,
    packet_ended  ///< the DATP that was still going out on the second line
  };
  using OutRow = Transition<FoldBack, OutInput, Out>;
  static const OutRow kOutputTable[];
  void on(OutInput input, Time now);

  /// After each input: updates the output half, and tells the blocks what has changed for them.
  void settle(Time now);
  void permit_folding(Time now);
  void tell_neighbours();
  /// Lets a slice in to the blocks.
  void enter(const wire::Slice& slice, Time now) {
    blocks_.receive(hears_second() ? Line::second : Line::first, slice, now);
  }

  /// @name Input half (fold_input.cpp)
  ///@{
  void greet_first_line(Time now);
  void drain_or_take(Time now);
  void leave_first_line(Time now);
  void leave_second_line(Time now);
  void take_first_line(Time now);
  void settle_input(Time now);
  void receive_first(const wire::Slice& slice, Time now);
  void answer(wire::FoldWord word);
  bool waits_for_last() const { return fold_node_ == from_; }
  void drain_if_settled(Time now);
  void hold(const wire::Slice& slice, Time now);
  void release(Time now);
  void drop_held();
  ///@}

  /// @name Output half (fold_output.cpp)
  ///@{
  void settle_output(Time now);
  void turn_back(Time now);
  void turn_forward(Time now);
  void greet_next_node();
  void break_off_output(Line line);
  ///@}

  /// @name What passes on the second line (fold_second_line.cpp)
  ///@{
  bool repeats() const { return in_ == In::first && out_ == Out::first; }
  void receive_second(const wire::Slice& slice, Time now);
  void break_off_second(Time now);
  bool has_come_round(wire::FoldWord word) const;
  void hear(wire::FoldWord word, const wire::Slice& slice, Time now);
  void hear_of_fold_node(wire::FoldWord word, const wire::Slice& slice, Time now);
  void forget_fold_node(Time now);
  void lose_second_input(Time now);
  void end_what_has_come_round(wire::FoldWord word, Time now);
  static bool goes_on_datp(wire::SliceKind kind) {
    return kind == wire::SliceKind::more || kind == wire::SliceKind::end || kind == wire::SliceKind::abort;
  }
  bool may_repeat(const wire::Slice& slice) const;
  void repeat(const wire::Slice& slice);
  void stop_repeating();
  void say(wire::FoldWordKind kind, NodeId node);
  void say_words(Time now);
  ///@}

  const Settings& settings() const { return blocks_.settings(); }
  NodeId id() const { return settings().id; }
  Duration repeat_period() const;
  NodeId neighbour(std::size_t lines) const { return node_after(settings().order, id(), lines); }
  std::size_t lines_between(NodeId from, NodeId to) const { return distance(settings().order, from, to); }

  Blocks& blocks_;
  Counters& counters_;
  wire::SliceWriter& first_;
  wire::SliceWriter& second_;
  const std::array<bool, 2>& ready_;

  bool input_up_ = false, output_up_ = false;  ///< of the first line
  NodeId from_, to_;                           ///< neighbours on it, now or last
  NodeId second_from_;                         ///< who sends to this node on the second line, now or last
  bool second_output_up_ = false;

  In in_ = In::second;
  HeldSlices held_;
  bool first_spoke_ = false;  ///< the upstream neighbour has sent on the first line: no longer on the second
  bool told_input_ = false;   ///< the blocks were told that their input is up

  Out out_ = Out::first;
  bool next_is_deaf_ = false;  ///< the next node hears nothing of us on the first line
  bool told_output_ = false;   ///< the blocks were told that their output is up

  std::optional<NodeId> fold_node_;  ///< the node that has turned back what comes in on the second line
  OpenPacket coming_second_;         ///< the DATP that is coming in on the second line
  OpenPacket repeated_;              ///< the one that this node is repeating
  OpenPacket given_out_;             ///< the one that the blocks are sending

  bool may_fold_ = false;  ///< both first lines have been up, or the permission timer has ended

  enum class Timer : std::uint8_t {
    permission,  ///< it may fold then, even if a first line has never been up
    words,       ///< its fold words are said again
    drain,       ///< what is still on the second line is given up
    fold_node,   ///< it is forgotten, unless it is announced again
    count
  };
  Timers<Timer> timers_;
};

}  // namespace limb_ring::core
