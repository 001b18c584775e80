#pragma once

#include <array>
#include <memory>

#include "core/blocks.h"
#include "core/fold/fold_back.h"
#include "core/journal.h"
#include "core/line.h"

namespace limb_ring::core {

/// The network controller of one node, the paper's Figure 1 and what was added to it: the four blocks, pins and
/// membership (blocks.h), and where the ring has a second line, the fold between the lines and the blocks
/// (fold_back.h).
///
/// It knows no IO and reads no clock. Time never runs backwards. Whoever drives it
///   1. tells it what happens: lines up and down, receive(), send(), interrupt(), set_cpu() ...; handle_timeout() once
///      next_deadline() has come;
///   2. after all inputs of an instant calls run();
///   3. takes what has come out: output() of each line, which it clears, take_event() and take() until they are empty.
///      Where it asked for something on the way, it calls run() again;
///   4. waits for the next input, at most until next_deadline().
/// A ring without a second line never uses Line::second: what is said of it then has no effect. (ours)
class NetworkController final : private Blocks {
 public:
  /// Sees each packet once, on whichever line it comes and goes, but not what the node only repeats on the second.
  class Tap {
   public:
    virtual ~Tap() = default;
    /// Before the blocks take a slice.
    virtual void arrives(const wire::Slice&, Line, Time) {}
    /// What the blocks have given out, framed.
    virtual void leaves(wire::ByteView framed_slices, Line, Time) = 0;
  };

  /// @param settings copied; with fold_back there is a second line
  NetworkController(const Settings& settings, Time now);

  /// @name The lines into and out of this node
  ///@{
  /// @pre it was down
  void input_up(Line line, NodeId from, Time now);
  void input_lost(Line line, Time now);
  /// Something was lost on it: a DATP that is coming in will never be whole.
  void input_gap(Line line, Time now);
  /// @pre it was down
  void output_up(Line line, NodeId to, Time now);
  void output_lost(Line line, Time now);
  /// Whether the line takes more for now. It does when it comes up.
  void set_output_ready(Line line, bool ready);
  /// One slice that came in on that line.
  void receive(Line line, const wire::Slice& slice, Time now);
  /// Framed slices for that line. Whoever asks for them writes and clears them.
  wire::SliceWriter& output(Line line) {
    wire::SliceWriter& framed = outputs_[index(line)];
    if (journal_ != nullptr && !framed.empty()) journal_->goes_out(line, framed.view());
    return framed;
  }
  /// The line that the node hears now, and the one that it sends on: at a fold the second.
  Line input_line() const { return fold_ && fold_->hears_second() ? Line::second : Line::first; }
  /// The second line stands for the input.
  bool input_folded() const { return fold_ && fold_->takes_second(); }
  Line output_line() const { return fold_ && fold_->turned_back() ? Line::second : Line::first; }
  Lines lines() const { return Lines(fold_ != nullptr); }
  ///@}

  /// @name The CPU and its helpers. Every call of the first three ends in exactly one SendEnded event.
  ///@{
  void send(const SendRequest& request, Time now);
  void interrupt(const InterruptRequest& request, Time now);
  /// Pulls interrupt input 0..7: sends the INTP it is wired to, without the CPU. (paper, protocol.md section 5.4)
  void pull(Owner owner, std::uint32_t token, unsigned input, Time now);
  void cancel(Owner owner, Time now);
  void set_cpu_present(bool present);
  void set_cpu(const CpuReport& report, Time now);
  /// The CPU was reset: empties its send queue and the receive buffers. (ours, protocol.md section 5.5)
  void cpu_reset(Owner cpu, Time now);
  /// Next packet for the CPU, by priority. @return false where none is due
  bool take(Time now, ReceivedPacket& out);
  ///@}

  /// @name Time and events
  ///@{
  void handle_timeout(Time now);
  void run(Time now);
  /// When handle_timeout(), run(), take_event() or take() have something new to do, or output() something to be
  /// written, if nothing else happens before.
  Time next_deadline(Time now) const;
  using Blocks::has_output;
  /// @return false where none is due
  bool take_event(Time now, Event& out);
  ///@}

  /// From now on `tap` sees the packets; null: nobody does. It must live as long as it is set.
  void set_tap(Tap* tap) { tap_ = tap; }
  /// From now on `journal` sees what goes in and out; null: nobody does. It must live as long as it is set.
  void set_journal(Journal* journal) { journal_ = journal; }

  /// A packet or a part of one has come in, and did not go out yet.
  bool holds_packets() const {
    return has_given_out() || !insertion_buffer().empty() || (fold_ && fold_->holds_slices());
  }

  using Blocks::counters;
  using Blocks::insertion_buffer;
  using Blocks::membership;
  using Blocks::received_waiting;
  using Blocks::settings;

  /// Its state, all but tap and journal. (archive.h) @pre to read: made with the same settings, and without any input
  /// so far
  template <class Archive>
  void archive(Archive& a) {
    Blocks::archive(a);
    a("outputs", outputs_)("ready", ready_);
    if (fold_) a("fold", *fold_);
  }

 private:
  template <class What>
  void note(const What& what, Time now) {
    if (journal_ != nullptr) journal_->goes_in(what, now);
  }
  static std::size_t index(Line line) { return static_cast<std::size_t>(line); }
  void take_in(Line line, const wire::Slice& slice, Time now);
  void enter(const wire::Slice& slice, Time now) override;
  bool has_given_out() const { return Blocks::has_given_out() || !outputs_[0].empty() || !outputs_[1].empty(); }
  void update_ready() { Blocks::set_output_ready(ready_[index(output_line())]); }

  std::array<wire::SliceWriter, 2> outputs_;
  std::array<bool, 2> ready_{true, true};
  std::unique_ptr<FoldBack> fold_;  ///< null: there is no second line
  Tap* tap_ = nullptr;
  Journal* journal_ = nullptr;
};

}  // namespace limb_ring::core
