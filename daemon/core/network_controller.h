#pragma once

#include <array>
#include <memory>
#include <variant>

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
///   1. tells it what happens, each as a value of journal.h: apply(input::InputUp{line, from}, now). input::Timeout
///   once
///      next_deadline() has come;
///   2. after all inputs of an instant applies input::Run;
///   3. takes what has come out: output() of each line, which it clears, take_event() and take() until they are empty.
///      Where it asked for something on the way, it applies input::Run again;
///   4. waits for the next input, at most until next_deadline().
/// A ring without a second line never uses Line::second: what is said of it then has no effect. (ours)
class NetworkController final {
 public:
  /// @param settings copied; with fold_back there is a second line
  NetworkController(const Settings& settings, Time now);

  /// Tells it one of the things in namespace input: the daemon, a simulated ring, a replay and a test alike.
  template <class What>
  void apply(const What& input, Time now) {
    if (journal_ != nullptr) journal_->goes_in(input, now);
    on(input, now);
  }
  void apply(const input::Receive& input, Time now) { receive(input.line, input.slice, now); }
  void apply(const Input& any, Time now) {
    std::visit([&](const auto& input) { apply(input, now); }, any);
  }
  /// input::Receive, without a copy of the slice.
  void receive(Line line, const wire::Slice& slice, Time now);
  /// input::OutputReady, if it is news. It takes no time.
  void set_output_ready(Line line, bool ready) {
    if (ready_[index(line)] != ready) apply(input::OutputReady{line, ready}, kNever);
  }
  /// input::CpuPresent. It takes no time.
  void set_cpu_present(bool present) { apply(input::CpuPresent{present}, kNever); }

  /// @name The lines into and out of this node
  ///@{
  /// Framed slices for that line. The caller writes and clears them.
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
  /// A packet or a part of one has come in, and did not go out yet.
  bool holds_packets() const {
    return has_given_out() || !insertion_buffer().empty() || (fold_ && fold_->holds_slices());
  }
  ///@}

  /// @name What comes out
  ///@{
  /// When input::Timeout, input::Run, take_event() or take() have something new to do, or output() something to be
  /// written, if nothing else happens before.
  Time next_deadline(Time now) const;
  /// take_event() or take() has something.
  bool has_output(Time now) const { return blocks_.has_output(now); }
  /// @return false if none is due
  bool take_event(Time now, Event& out);
  /// Next packet for the CPU, by priority. @return false if none is due
  bool take(Time now, ReceivedPacket& out);
  ///@}

  /// @name Who sees it
  ///@{
  /// From now on `tap` sees the packets; null: nobody does. It must live as long as it is set.
  void set_tap(Tap* tap) { blocks_.set_tap(tap); }
  /// From now on `journal` sees what goes in and out; null: nobody does. It must live as long as it is set.
  void set_journal(Journal* journal) { journal_ = journal; }
  ///@}

  const Settings& settings() const { return blocks_.settings(); }
  const Counters& counters() const { return blocks_.counters(); }
  Counters& counters() { return blocks_.counters(); }
  const Membership& membership() const { return blocks_.membership(); }
  const InsertionBuffer& insertion_buffer() const { return blocks_.insertion_buffer(); }
  std::size_t received_waiting() const { return blocks_.received_waiting(); }
  std::size_t received_waiting(wire::Priority priority) const { return blocks_.received_waiting(priority); }

  /// Its state, all but tap and journal. (archive.h) @pre to read: made with the same settings, and without any input
  /// so far
  template <class Archive>
  void archive(Archive& a) {
    blocks_.archive(a);
    a("outputs", outputs_)("ready", ready_);
    if (fold_) a("fold", *fold_);
  }

 private:
  void on(const input::InputUp& up, Time now);
  void on(const input::InputLost& lost, Time now);
  void on(const input::InputGap& gap, Time now);
  void on(const input::OutputUp& up, Time now);
  void on(const input::OutputLost& lost, Time now);
  void on(const input::OutputReady& output, Time) {
    ready_[index(output.line)] = output.ready;
    blocks_.set_output_ready(ready_[index(output_line())]);
  }
  void on(const input::Send& send, Time now) { blocks_.send(send.request, now); }
  void on(const input::Interrupt& interrupt, Time now) { blocks_.interrupt(interrupt.request, now); }
  void on(const input::Pull& pull, Time now) { blocks_.pull(pull.owner, pull.token, pull.input, now); }
  void on(const input::Cancel& cancel, Time now) { blocks_.cancel(cancel.owner, now); }
  void on(const input::CpuReset& reset, Time now) { blocks_.cpu_reset(reset.cpu, now); }
  void on(const input::Cpu& cpu, Time now) { blocks_.set_cpu(cpu.report, now); }
  void on(const input::CpuPresent& cpu, Time) { blocks_.set_cpu_present(cpu.present); }
  void on(const input::Timeout&, Time now);
  void on(const input::Run&, Time now);

  static std::size_t index(Line line) { return static_cast<std::size_t>(line); }
  void take_in(Line line, const wire::Slice& slice, Time now);
  bool has_given_out() const { return blocks_.has_given_out() || !outputs_[0].empty() || !outputs_[1].empty(); }

  Blocks blocks_;
  std::array<wire::SliceWriter, 2> outputs_;
  std::array<bool, 2> ready_{true, true};
  std::unique_ptr<FoldBack> fold_;  ///< null: there is no second line
  Journal* journal_ = nullptr;
};

}  // namespace limb_ring::core
