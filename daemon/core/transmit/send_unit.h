#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/counters.h"
#include "core/events.h"
#include "core/settings.h"
#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::core {

/// The one packet of its kind that a node has outstanding: its image, its tries, its time-out.
/// A node does not send its next packet until the last one is back. (paper) Time-out and retries
/// are ours.
class Flight {
 public:
  enum class Phase { idle, waiting, out };  ///< waiting: for the line, before a try

  Phase phase() const { return phase_; }
  bool idle() const { return phase_ == Phase::idle; }
  Time waiting_since() const { return since_; }
  /// Of the try that is out, or until when the next one may wait for the line.
  Time deadline() const { return phase_ == Phase::idle ? kNever : deadline_; }
  Time sent_at() const { return sent_at_; }
  Time first_sent_at() const { return first_sent_at_; }
  wire::ByteView image() const { return {bytes_->data(), size_}; }
  wire::NodeId destination() const { return wire::PacketFields{image()}.destination(); }

  /// A new packet, which goes onto the line at once; the caller writes `data_size` bytes where the result points.
  std::uint8_t* load(wire::Code code, wire::NodeId source, wire::NodeId destination, std::uint8_t last,
                     std::size_t data_size);
  /// Its next try goes onto the line now.
  wire::ByteView launch(Time now, Duration timeout);
  /// True if `packet` is what was sent last: Code, DID, last field, size, and the data through
  /// the CRC with HOP and FBC put back. (ours, protocol.md section 4.2) @pre its CRC is good
  bool is_return(const wire::PacketFields& packet) const;
  /// A try has failed. @param until when the next one may wait for the line @return false if no more are left
  bool retry(Time now, Time until);
  void clear() { phase_ = Phase::idle; }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("phase", phase_)("interrupt", code_.interrupt)("attempt", code_.attempt)("sequence", code_.sequence);
    a("incarnation", code_.incarnation)("since", since_)("sent_at", sent_at_)("first_sent_at", first_sent_at_);
    a("deadline", deadline_);
    a("size", size_)("bytes", *bytes_, size_);
  }

 private:
  Phase phase_ = Phase::idle;
  wire::Code code_;
  Time since_{};
  Time sent_at_{};        ///< first byte of the last try
  Time first_sent_at_{};  ///< ... of the first try
  Time deadline_{};
  std::size_t size_ = 0;
  using Bytes = std::array<std::uint8_t, wire::kMaxDataPacketSize>;
  std::unique_ptr<Bytes> bytes_ = std::make_unique<Bytes>();  ///< on the heap: kept away from what every hop reads
};

/// Sequence numbers of one kind of packet: per DID, from 0 after a hello, broadcast being a DID of
/// its own. Three bits wrap; a receiver that has decided none of the last 7 could mistake a new
/// packet for an old one, so after 6 sends in a row without its verdict new numbers are due. (ours, protocol.md
/// section 4.7)
class SequenceNumbers {
 public:
  /// Code of a first try to `destination`.
  wire::Code next(bool interrupt, wire::NodeId destination) {
    const wire::Sequence sequence{static_cast<std::uint8_t>((*counts_)[destination].next++ & 7)};
    return {interrupt, 0, sequence, incarnation_};
  }
  void decided(wire::NodeId destination) { (*counts_)[destination].undecided = 0; }
  void undecided(wire::NodeId destination) {
    if (++(*counts_)[destination].undecided >= kMostUndecided) exhausted_ = true;
  }
  /// New numbers (a new hello) are due.
  bool exhausted() const { return exhausted_; }
  /// The numbers of a new incarnation.
  void restart(std::uint64_t boot) {
    *this = {};
    incarnation_ = wire::incarnation_of(boot);
  }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("counts", *counts_)("exhausted", exhausted_)("incarnation", incarnation_);
  }

 private:
  static constexpr int kMostUndecided = 6;
  struct Count {
    std::uint8_t next = 0;
    std::uint8_t undecided = 0;
    template <class Archive>
    void archive(Archive& a) {
      a("next", next)("undecided", undecided);
    }
  };
  using Counts = std::array<Count, 256>;
  std::unique_ptr<Counts> counts_ = std::make_unique<Counts>();  ///< on the heap, as Flight's bytes
  bool exhausted_ = false;
  wire::Incarnation incarnation_{};
};

/// What a unit of Transmit may send.
enum class Gate : std::uint8_t {
  closed,   ///< nothing
  control,  ///< the NC's own hello only
  open
};

/// What the two units of Transmit have in common: one packet outstanding, whose return is its acknowledgement (paper);
/// its tries, its time-out, and one result for every send. (ours, protocol.md sections 4.2 to 4.6)
class SendUnit {
 public:
  SendUnit(const SendUnit&) = delete;
  SendUnit& operator=(const SendUnit&) = delete;

  void set_gate(Gate gate, Time now) {
    gate_ = gate;
    free_at_ = std::max(free_at_, now);  // what waited at the gate asks for the line only from now on
  }
  /// Open chain: nothing returns, so every send ends `unconfirmed` as it leaves, at a pace.
  void set_open_chain(bool open, Time now);

  /// True while a packet is out, or waits for its retry.
  bool busy() const { return !flight_.idle(); }
  /// `packet` is what was sent last, and is not home yet. @pre its CRC is good
  bool expects(const wire::PacketFields& packet) const { return flight_.is_return(packet); }
  /// An own packet came home with a good CRC; `fbc`: what the receivers wrote.
  /// @param doubtful the FBC proves nothing (Membership::has_merged): the send ends lost, if it is a user's
  /// @return true if it was the packet outstanding
  bool returned(const wire::PacketFields& packet, std::uint8_t fbc, bool doubtful, Time at);
  /// An own packet came home damaged or broken off: a failed try.
  void returned_damaged(Time at);

  /// `peer` has restarted and forgotten what it took. What it may have taken before is not repeated: it would take it
  /// twice. (ours, protocol.md section 4.10)
  void forgotten_by(NodeId peer, Time now);

  /// Its sequence numbers start again at 0, in the incarnation of that boot number.
  void restart_numbers(std::uint64_t boot) { numbers_.restart(boot); }
  bool numbers_exhausted() const { return numbers_.exhausted(); }
  /// What was sent last.
  wire::ByteView image() const { return flight_.image(); }

 protected:
  /// A send on its way to its end.
  struct Send {
    SendEnded end;  ///< who asked for it, where to, and at its end how it ended
    Time asked{};
    bool repeated = false;   ///< some try had to be repeated: an earlier one may have been taken
    bool forgotten = false;  ///< its receiver restarted while it was out: not repeated
    bool told = false;       ///< its result was given already (cancelled while out)
    template <class Archive>
    void archive(Archive& a) {
      a("end", end)("asked", asked)("repeated", repeated)("forgotten", forgotten)("told", told);
    }
  };

  SendUnit(const Settings& settings, Counters& counters, EventQueue& events)
      : settings_(settings), counters_(counters), events_(events) {}
  ~SendUnit() = default;

  /// The send whose packet is out, or waits for its retry. @pre busy()
  virtual Send& outstanding() = 0;
  /// Takes it out of its queue.
  virtual void pop_outstanding() = 0;
  virtual void count_return() = 0;
  /// It came home refused (FBC 0). @return true if it goes again later
  virtual bool goes_again(Time at) = 0;
  /// Where the end of a send is told.
  virtual void give_out(const SendEnded& ended, Time at);

  /// Puts the next try onto the line. In an open chain the send ends with that, and busy() is false.
  wire::ByteView launch(Time now);
  void end_outstanding(Outcome outcome, Time at, Duration round_trip = Duration{0});
  /// Tells the result, if it was not told before.
  void tell(Send& send, Outcome outcome, Time at, Duration round_trip = Duration{0});
  /// At flight_.deadline().
  void handle_try_timeout(Time now);
  Time overdue_at(const Send& send) const { return send.asked + settings_.queue_timeout; }
  void give_up(Time at);
  /// A send that has its result already is not repeated, even if its retry waits for the line.
  void give_up_told_retry(Time now) {
    if (flight_.phase() == Flight::Phase::waiting && outstanding().told) give_up(now);
  }

  template <class Archive>
  void archive_unit(Archive& a) {
    a("gate", gate_)("flight", flight_)("free_at", free_at_)("numbers", numbers_)("open_chain", open_chain_);
  }

  const Settings& settings_;
  Counters& counters_;
  EventQueue& events_;
  Gate gate_ = Gate::closed;
  Flight flight_;
  Time free_at_{};  ///< nothing goes earlier: tail of the last return, gate opened, pace of an open chain
  SequenceNumbers numbers_;

 private:
  void fail_try(Time at);
  Time retry_until(const Send& send, Time at) const;
  void decide(std::uint8_t fbc, Time at);

  bool open_chain_ = false;
};

}  // namespace limb_ring::core
