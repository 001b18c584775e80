#pragma once

#include <algorithm>
#include <optional>

#include "core/blocks.h"
#include "wire/fold_mark.h"

namespace limb_ring::core {

/// A node's place in ring order, from 0; nodes() where it has none.
inline std::size_t place_of(const Settings& settings, NodeId node) {
  return static_cast<std::size_t>(std::find(settings.order.begin(), settings.order.end(), node) -
                                  settings.order.begin());
}

/// Fold-back around a break, with a second, counter-rotating line. (ours, protocol.md sections 8.7 to 8.12; Honda's
/// own answer is switches to a redundant line, US10742444)
///
/// It stands between a node's four lines and its blocks. The node before a break turns its
/// output back onto the second line; on that one all others only repeat, and the node behind the break takes
/// it for its input. So the blocks see each packet once, in ring order:
///
///     first line     a -> b    c -> d -> a          the line from b to c is broken
///     second line    a <- b    c <- d <- a          b turns back, a and d repeat, c takes
///
/// Bytes and time in, bytes and a deadline out, as Blocks. After Blocks::run() comes carry().
class FoldBack {
 public:
  /// All must outlive this. @pre blocks.settings().fold_back
  /// @param first,second what goes onto the lines; whoever writes them clears them
  FoldBack(Blocks& blocks, wire::SliceWriter& first, wire::SliceWriter& second, Time now);
  FoldBack(const FoldBack&) = delete;
  FoldBack& operator=(const FoldBack&) = delete;

  /// @name The first line
  ///@{
  void input_up(NodeId from, Time now);
  void input_lost(Time now);
  void input_gap(Time now);
  void output_up(NodeId to, Time now);
  void output_lost(Time now);
  void receive(const wire::Slice& slice, Time now);
  ///@}

  /// @name The second line: its input comes from the next node, its output goes to the one before
  /// Its input being up does not mean that there is a fold; the words and packets on it do.
  ///@{
  void second_input_up(NodeId from) { second_from_ = from; }
  void second_input_lost(Time now);
  void second_input_gap(Time now);
  void second_output_up(Time now);
  void second_output_lost(Time now);
  void receive_second(const wire::Slice& slice, Time now);
  ///@}

  /// Divides what the blocks have given out among the lines; leaves it empty.
  void carry(wire::SliceWriter& given_out, Time now);

  /// The output goes onto the second line.
  bool turned_back() const { return out_ != Out::first; }
  /// The second line stands for the input.
  bool takes_second() const { return in_ != In::first && tail_; }

  void handle_timeout(Time now);
  Time deadline() const { return std::min(std::min(patience_, say_again_), std::min(drain_due_, tail_due_)); }

 private:
  /// draining: the first line is back, and what is on the second comes first.
  enum class In : std::uint8_t { first, second, draining };
  /// leaving: the first line is back, and a packet is still going out on the second.
  enum class Out : std::uint8_t { first, second, leaving };

  void settle(Time now);
  void tell_turned_back() {
    blocks_.set_turned_back_at(takes_second() ? tail_ : std::nullopt);
  }
  void tell_folded(Time now) {
    blocks_.set_folded(takes_second(), turned_back() && told_output_, now);
  }
  void settle_input(Time now);
  void settle_output(Time now);
  void turn_back(Time now);
  void back_to_first();
  void greet_on_first();
  void tell_neighbours();
  void put_out(const wire::Slice& slice);

  void begin_draining(Time now);
  bool waits_for_last() const { return tail_ == from_; }
  void drain_if_settled(Time now);
  void drained(Time now);
  void hold(const wire::Slice& slice, Time now);
  void release(Time now);
  void drop_held();

  bool repeats() const { return in_ == In::first && out_ == Out::first; }
  bool has_come_round(wire::FoldWord word) const;
  void answer(wire::FoldWord word);
  void hear(wire::FoldWord word, const wire::Slice& slice, Time now);
  void hear_of_tail(wire::FoldWord word, const wire::Slice& slice, Time now);
  void forget_tail(Time now);
  /// Whether a DATP is under way after this slice.
  static bool open_after(const wire::Slice& slice, bool open);
  void break_off_second(Time now);
  void say(wire::FoldMark mark, NodeId node) { wire::put(second_, {mark, node}); }
  void say_again(Time now);
  void lose_tail(Time now);
  Duration pause() const;
  NodeId id() const { return blocks_.settings().id; }

  Blocks& blocks_;
  Counters& counters_;
  wire::SliceWriter& first_;
  wire::SliceWriter& second_;

  bool input_up_ = false, output_up_ = false;
  bool second_output_up_ = false;
  NodeId from_, to_;            ///< neighbours on the first line, now or last
  NodeId second_from_;          ///< who sends to this node on the second line, now or last
  In in_ = In::second;
  Out out_ = Out::first;
  bool next_is_deaf_ = false;   ///< the next node hears nothing of us on the first line
  std::optional<NodeId> tail_;  ///< where what comes in on the second line was turned back
  bool second_open_ = false;    ///< a DATP is coming in on the second line
  bool out_open_ = false;       ///< a DATP is going out on the second line
  bool told_input_ = false, told_output_ = false;  ///< as the controller was told: up

  wire::SliceWriter held_;      ///< of the first line, until the second has drained
  std::size_t released_ = 0;    ///< bytes of them

  bool first_spoke_ = false;    ///< its sender has spoken on it, so it sends on the second line no more
  bool may_fold_ = false;       ///< both first lines have been up, or break_grace has passed since the start
  Time patience_ = kNever;
  Time say_again_ = kNever;
  Time drain_due_ = kNever;
  Time tail_due_ = kNever;      ///< the fold node (tail) is forgotten then, unless it is announced again
};

}  // namespace limb_ring::core
