#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/line.h"
#include "core/settings.h"
#include "model/packet.h"
#include "wire/control_message.h"

namespace limb_ring::model {

using core::Line;
using wire::FoldWordKind;

/// What stands behind the fold: the NC with its one input and its one output.
class BehindFold {
 public:
  virtual ~BehindFold() = default;
  struct Lines {
    bool input_up = false, output_up = false;
    bool input_folded = false, output_folded = false;
    int before = 0, next = 0;  ///< on the first line: those that were there last, if nobody is
  };
  virtual void lines_are(const Lines& lines, Time now) = 0;
  /// A DATP that is coming in will never be whole.
  virtual void input_breaks(Time now) = 0;
  /// What waits for the output, or is going out, will never leave.
  virtual void output_breaks(Time now) = 0;
  virtual void slice_comes(const Given& slice, Time now) = 0;
  /// A DATP is going out.
  virtual bool is_mid_packet() const = 0;
  /// The insertion buffer has room for what begins with that.
  virtual bool takes(const Given& slice) const = 0;
};

/// The fold between a node's four lines and its NC: protocol.md sections 8.7 to 8.11.
class FoldBack {
 public:
  using Lines = std::array<std::vector<Given>, 2>;
  /// @param given what goes onto the two lines
  FoldBack(const core::Settings& settings, BehindFold& nc, Lines& given, Time now);

  void input_up(Line line, int from, Time now);
  void input_lost(Line line, Time now);
  void input_gap(Line line, Time now);
  void output_up(Line line, int to, Time now);
  void output_lost(Line line, Time now);
  void receive(Line line, const Given& slice, Time now);
  /// What the NC gives out: it leaves at the end of the instant.
  void send(const Given& slice) { sent_.push_back(slice); }
  void drop_sent() { sent_.clear(); }
  void carry(Time now);
  void run(Time now);
  void timers(Time now);
  Time next_deadline() const;

  bool takes_second() const { return input_ != Half::first; }
  bool turned_back() const { return output_ != Half::first; }
  const std::optional<int>& fold_node() const { return fold_node_; }
  std::string in_words() const;

 private:
  /// Of the input half `between` is *draining*, of the output half *leaving*.
  enum class Half { first, second, between };
  struct Ends {
    std::optional<int> from, to;
  };

  // -- fold_back.cpp: lines and time
  void tell_nc(Time now);
  bool folded() const { return takes_second() || turned_back(); }
  bool repeats() const { return !folded() && fold_node_; }
  void say(Line line, FoldWordKind kind, int node);
  void put_word(Line line, FoldWordKind kind, int node);
  void say_again(Time now);
  unsigned lines_between(int from, int to) const;
  bool lies_between(int node, int from, int to) const;

  // -- fold_input.cpp: protocol.md section 8.9
  void first_slice(const Given& slice, Time now);
  void hold(const Given& slice, Time now);
  void drain(Time now);
  void input_to_first(Time now);
  void give_held(Time now);
  void to_nc(const Given& slice, Time now);

  // -- fold_output.cpp: protocol.md section 8.10
  void decide_output(Time now);
  void put_onto_line();
  void say_begin();
  bool end_leaving(Time now);
  void output_to_first(Time now);
  void abort_sent(Line line);

  // -- fold_second_line.cpp: protocol.md section 8.11
  void second_slice(const Given& slice, Time now);
  void word(FoldWordKind kind, int node, Time now);
  void begin(int node, Time now);
  void forget_fold_node(Time now);
  void break_off_second(Time now);
  void goes_round(FoldWordKind kind, int node, Time now);
  void repeat(const Given& slice);
  void abort_repeated();

  core::Settings settings_;
  BehindFold& nc_;
  Lines& given_;
  Duration period_;  ///< of words that are said again
  Time allowed_at_;  ///< fold permission
  bool may_fold_ = false;
  Time again_at_ = kNever;

  int upstream_, downstream_;  ///< the neighbours on the first line: the last ones, at first those of the ring's order

  std::array<Ends, 2> lines_;

  Half input_ = Half::second;
  bool has_spoken_ = false;  ///< the upstream neighbour, on the first line, since that is back
  Time drained_at_ = kNever;
  std::deque<Given> held_;
  bool open_on_first_ = false;   ///< a DATP that comes in on the first line, at the NC
  bool open_on_second_ = false;  ///< one that comes in on the second line, at the NC or repeated
  bool open_repeated_ = false;   ///< one that goes out on the second line again

  Half output_ = Half::first;
  bool next_is_deaf_ = false;
  bool nc_output_ = false;   ///< the NC has been told that its output is up
  std::vector<Given> sent_;  ///< in this instant
  bool open_sent_ = false;   ///< a DATP of the NC on the line

  std::optional<int> fold_node_;
  Time fold_node_heard_{};
};

}  // namespace limb_ring::model
