#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/counters.h"
#include "core/settings.h"
#include "core/slot_queue.h"
#include "core/time.h"
#include "core/transmit/transmit.h"
#include "wire/packet.h"
#include "wire/slice.h"

namespace limb_ring::core {

/// A DATP that Relay has handed to the Packet Manager, perhaps still coming in.
struct RelayedPacket {
  enum class State : std::uint8_t { receiving, complete, aborted } state = State::receiving;
  Time arrived{};          ///< when its header came in: decides the order
  Time tail_at{};          ///< when its end came in
  std::uint16_t size = 0;  ///< bytes that have come in
  std::array<std::uint8_t, wire::kMaxDataPacketSize> bytes;

  template <class Archive>
  void archive(Archive& a) {
    a("state", state)("arrived", arrived)("tail_at", tail_at)("size", size)("bytes", bytes, size);
  }
};

/// Where relayed DATPs wait while the line is taken (paper: "the other waits in a buffer").
/// Bounded in bytes: room for one DATP of the largest size is enough while nothing is lost and the output is no slower
/// than the input, also for many small ones; each further copy of an own packet in flight adds one. Before a slower
/// output, or if packets come late, one of each other node may wait. (ours, protocol.md section 2.5)
class InsertionBuffer {
 public:
  /// @param capacity DATPs of the largest size
  explicit InsertionBuffer(unsigned capacity) : most_bytes_(capacity * wire::kMaxDataPacketSize) {}

  bool empty() const { return packets_.empty(); }
  /// No room for a DATP of the largest size: how long one will be is not known when it begins.
  bool full() const { return bytes_ + wire::kMaxDataPacketSize > most_bytes_; }
  std::size_t count() const { return packets_.size(); }
  /// Bytes of all packets in it, with those of the front one that have left already.
  std::size_t bytes() const { return bytes_; }
  RelayedPacket& front() { return packets_.front(); }
  const RelayedPacket& front() const { return packets_.front(); }
  RelayedPacket& back() { return packets_[packets_.size() - 1]; }
  /// @pre !full()
  RelayedPacket& push(Time now) {
    RelayedPacket& slot = packets_.push();
    slot.state = RelayedPacket::State::receiving;
    slot.arrived = slot.tail_at = now;  // nothing of the slot's last packet stays: replays compare it
    slot.size = 0;
    return slot;
  }
  /// `bytes` more bytes of the last packet have come in.
  void grow(std::size_t bytes) {
    back().size = static_cast<std::uint16_t>(back().size + bytes);
    bytes_ += bytes;
  }
  void pop() {
    bytes_ -= front().size;
    packets_.pop();
  }
  void pop_back() {
    bytes_ -= back().size;
    packets_.pop_back();
  }
  void clear() {
    packets_.clear();
    bytes_ = 0;
  }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("bytes", bytes_)("packets", packets_);
  }

 private:
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  SlotQueue<RelayedPacket> packets_;
};

/// Packet Manager: chooses what goes onto the outgoing line (step()). What came in first goes first; on a
/// tie Transmit wins over Relay; an INTP goes before any DATP and is embedded into a DATP already
/// on its way out, at a word boundary. (paper; word grid and buffer limits ours, protocol.md sections 2.4, 2.5
/// and 5.2)
///
/// Time on the line: a byte takes `byte_time_out`. A `start` slice is given out as its header
/// begins, an INTP as it begins, an `end` slice as its last odd bytes, trailer and CRC begin, so
/// that downstream can decide in the instant a real relay would. With byte time 0 everything
/// that is there goes at once.
class PacketManager {
 public:
  PacketManager(const Settings& settings, Transmit& transmit, Counters& counters, wire::SliceWriter& line);

  /// @name From Relay: one DATP at a time, whole or begin, words, end or abort; HOP, FBC and CRC are Relay's
  ///@{
  /// One more DATP of the largest size fits; without an output none is kept, so one always does.
  bool has_room() const { return !output_up_ || !buffer_.full(); }
  const InsertionBuffer& insertion_buffer() const { return buffer_; }
  /// Where a DATP is to be put.
  struct Place {
    std::uint8_t* bytes;  ///< null if there is no output: it is dropped
    bool on_line;         ///< true: the line was free, and the DATP is on it already
  };
  /// A whole DATP of `size` bytes, which the caller puts there before it calls anything else.
  Place relay_whole(std::size_t size, Time now);
  /// One that comes in piece by piece. @return where its bytes are to be put; null if there is no output
  std::uint8_t* relay_begin(Time now);
  /// So many more bytes are in place, and may go on.
  void relay_words(std::size_t bytes) {
    if (receiving_) buffer_.grow(bytes);
  }
  /// The last bytes are in place.
  void relay_end(std::size_t bytes, Time now);
  void relay_abort();
  /// If the bytes of the one that is coming in lie; null if none is, or if there is no output.
  std::uint8_t* receiving_place() { return receiving_ ? buffer_.back().bytes.data() : nullptr; }
  ///@}
  /// An INTP, HOP and FBC already rewritten.
  void relay_interrupt(const wire::InterruptBytes& packet, Time now);

  /// The line: there, gone (what waits is dropped and counted), able to take more.
  void output_up(Time now);
  void output_lost();
  void set_ready(bool ready) {
    if (ready == ready_) return;
    released_ = released_ || ready;
    ready_ = ready;
  }

  /// The header of a DATP is on the line, and its end is not.
  bool is_open() const { return is_open_; }
  /// Puts onto the line all that may go now.
  /// @return true if something of Transmit's has begun
  bool run(Time now);
  /// When run() has something to do again, if nothing else happens.
  Time deadline() const;
  /// archive.h; Transmit comes before it
  template <class Archive>
  void archive(Archive& a) {
    a("buffer", buffer_)("interrupts", interrupts_)("output_up", output_up_)("ready", ready_)("released", released_);
    a("receiving", receiving_)("open", is_open_)("open.own", open_.own)("open.sent", open_.sent)("open.grid",
                                                                                                 open_.grid);
    a("free_at", free_at_);
    if (is_open_ && open_.own) open_.own_bytes = transmit_.data.image();
  }

 private:
  struct RelayedInterrupt {
    wire::InterruptBytes bytes;
    Time arrived;
    template <class Archive>
    void archive(Archive& a) {
      a("bytes", bytes)("arrived", arrived);
    }
  };
  /// The DATP whose header is on the line and whose end is not.
  struct Open {
    bool own = false;
    wire::ByteView own_bytes;
    std::size_t sent = 0;  ///< bytes given out so far
    Time grid{};           ///< when its first payload byte goes, later by each INTP embedded
  };

  bool paced() const { return settings_.byte_time_out.count() != 0; }
  Duration bytes_time(std::size_t bytes) const { return settings_.byte_time_out * static_cast<std::int64_t>(bytes); }
  /// How much later than on the input a part of `bytes` bytes may begin on the output. If the output is faster, it has
  /// to wait: no byte leaves before it has come in. (ours, protocol.md section 6.4)
  Duration lag(std::size_t bytes) const {
    return std::max(Duration{0}, settings_.byte_time_in - settings_.byte_time_out) * static_cast<std::int64_t>(bytes);
  }
  bool line_is_free(Time now) const;
  void count_drop(std::uint64_t packets) { counters_.dropped_no_output += packets; }
  /// The line is there, takes more, and what has gone onto it is through.
  bool may_put(Time now) const { return output_up_ && ready_ && free_at_ <= now; }
  bool step(Time now);

  Time interrupt_at() const {
    if (interrupts_.empty() && !transmit_.interrupts.has_work()) return kNever;
    const Time relayed = interrupts_.empty() ? kNever : interrupts_.front().arrived;
    const Time since = std::min(transmit_.interrupts.ready_at(), relayed);
    return since == kNever ? kNever : interrupt_place(since);
  }
  Time interrupt_place(Time since) const;
  void put_interrupt(Time at);

  wire::ByteView open_bytes() const;
  bool open_complete() const { return open_.own || buffer_.front().state == RelayedPacket::State::complete; }
  bool open_aborted() const { return !open_.own && buffer_.front().state == RelayedPacket::State::aborted; }
  Time next_word(Time from) const;
  Time open_end_at() const;
  void put_words_until(Time at);
  bool advance_open(Time now);
  void close_open();

  Time relayed_since() const { return buffer_.empty() ? kNever : buffer_.front().arrived; }
  void open_data(bool own, Time at);

  const Settings& settings_;
  Transmit& transmit_;
  Counters& counters_;
  wire::SliceWriter& line_;
  InsertionBuffer buffer_;
  SlotQueue<RelayedInterrupt> interrupts_;
  bool output_up_ = false;
  bool ready_ = true;
  bool released_ = false;   ///< the line has just begun to take more
  bool receiving_ = false;  ///< buffer_.back() is still coming in
  bool is_open_ = false;
  bool own_begun_ = false;  ///< in this run()
  Open open_;
  Time free_at_{};  ///< when the header, INTP or tail on the line is through
};

}  // namespace limb_ring::core
