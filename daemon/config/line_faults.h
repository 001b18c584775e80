#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "config/fault.h"
#include "core/time.h"
#include "wire/slice.h"

namespace limb_ring::fault {

using core::Duration;
using core::Time;

/// Slices that a line holds back, in order. (ours)
class HeldSlices {
 public:
  /// @param byte_time of the line: what was held back goes on no faster
  explicit HeldSlices(Duration byte_time) : byte_time_(byte_time) {}

  bool empty() const { return slices_.empty(); }
  std::size_t count() const { return slices_.size(); }
  /// With the framing.
  std::size_t bytes() const { return bytes_; }
  /// The last one that went on is through.
  bool line_free(Time now) const { return free_at_ <= now; }

  /// @param due when it may go on at the earliest; never before those that are held already
  void put(wire::SliceKind kind, wire::ByteView bytes, Time due) {
    slices_.push_back({due, kind, {bytes.begin(), bytes.end()}});
    bytes_ += size_of(slices_.back());
  }
  /// Nothing goes on before `time`.
  void block_until(Time time) { free_at_ = std::max(free_at_, time); }
  /// When the next one may go on, kNever if there is none. @param pace least time per byte, beside the line's own
  Time next(Duration pace) const {
    if (slices_.empty()) return core::kNever;
    const Held& first = slices_.front();
    const auto size = static_cast<std::int64_t>(first.bytes.size());
    // By its due time a slice has passed at the line's own pace; at a slower pace it only begins then.
    return std::max({first.due, free_at_ + byte_time_ * size, std::max(first.due, free_at_) + pace * size});
  }
  /// The next one goes on. @pre next(pace) is not in the future
  void take(Duration pace, wire::SliceWriter& out) {
    free_at_ = next(pace);
    const Held& first = slices_.front();
    out.put(first.kind, {first.bytes.data(), first.bytes.size()});
    bytes_ -= size_of(first);
    slices_.pop_front();
  }
  void clear() {
    slices_.clear();
    bytes_ = 0;
  }

 private:
  struct Held {
    Time due;
    wire::SliceKind kind;
    std::vector<std::uint8_t> bytes;
  };
  static std::size_t size_of(const Held& held) { return wire::kSliceHeaderSize + held.bytes.size(); }

  Duration byte_time_;
  Time free_at_{};
  std::deque<Held> slices_;
  std::size_t bytes_ = 0;
};

/// What the faults of a line have done to packets: (name, what one count means).
#define LIMB_RING_LINE_COUNTERS(X)                                                          \
  X(line_dropped, "packet dropped by a fault of the line")                                  \
  X(line_corrupted, "packet with one bit made wrong by a fault of the line")                \
  X(line_truncated, "DATP broken off by a fault of the line")                               \
  X(line_duplicated, "packet doubled by a fault of the line")                               \
  X(line_reordered, "packet discarded as late: a fault of the line put it behind the next") \
  X(line_aborted, "DATP broken off because an INTP inside it was late")                     \
  X(line_delayed, "packet made later by a fault of the line")                               \
  X(line_held, "packet that had to wait for a stall, a rate or one before it")              \
  X(line_full, "packet dropped whole: too much was held back")                              \
  X(line_cut, "packet lost because a fault had cut the line")                               \
  X(line_lost, "slice that was held back when its line was cut or replaced")

struct LineCounters {
#define LIMB_RING_LINE_COUNTER_MEMBER(name, meaning) std::uint64_t name = 0;
  LIMB_RING_LINE_COUNTERS(LIMB_RING_LINE_COUNTER_MEMBER)
#undef LIMB_RING_LINE_COUNTER_MEMBER

  /// Calls visit(name, meaning, value) for each, in the order above.
  template <class Visit>
  void each(Visit visit) const {
#define LIMB_RING_LINE_COUNTER_VISIT(name, meaning) visit(#name, meaning, name);
    LIMB_RING_LINE_COUNTERS(LIMB_RING_LINE_COUNTER_VISIT)
#undef LIMB_RING_LINE_COUNTER_VISIT
  }
};

/// Everything that is wrong with one directed line. It knows no IO: slices go in with the time, slices and a
/// deadline come out. The same faults, slices, times and seed give the same damage. (ours)
///
/// A packet is hit whole, however many slices it travels in; an INTP inside a DATP is a packet of its own.
/// A damaged packet has one bit wrong, anywhere behind its header; of one that travels in several slices, in the last.
/// A truncated DATP ends in an abort. A link keeps order (protocol.md section 6.1), so a packet that would come behind
/// the next one counts as late and never arrives; if it was an INTP inside a DATP, the gap aborts that DATP.
/// On a line with a data rate, what was held back goes on no faster than that.
class LineFaults {
 public:
  using Id = std::uint32_t;  ///< of one fault, from 1
  /// Most bytes that are held back, the rest of a packet that has begun apart; further packets are dropped whole.
  static constexpr std::size_t kLimit = 256 << 10;

  /// @param byte_time of the line, 0: as fast as it takes them
  explicit LineFaults(std::uint64_t seed, Duration byte_time = Duration{0})
      : random_(seed), byte_time_(byte_time), held_(byte_time) {}

  /// @pre the fault is of a line. @return 0 for heal, which ends all others
  Id begin(const Fault& fault, Time now);
  /// What it held back goes on. @return false if there is no such fault (any more)
  bool remove(Id id);
  void clear() { active_.clear(); }

  struct Listed {
    Id id;
    Fault fault;
    bool waits;          ///< has not started yet
    std::uint64_t hits;  ///< packets
  };
  /// All that have not ended, in the order in which they began.
  std::vector<Listed> list(Time now);

  /// True if the wire is broken now: the caller takes the line down, and up again when this is false again.
  bool cut(Time now);
  /// Nothing passes now, not even what says that the line is alive.
  bool stalled(Time now) const;
  /// A slice comes onto the line. What passes of it comes out of take(), in the same instant at the earliest.
  void pass(const wire::Slice& slice, Time now);
  /// Appends to `out` what is due on the line by now.
  void take(Time now, wire::SliceWriter& out);
  /// When to call cut() and take() again, kNever: not before the next slice or fault. As of the last call.
  Time next_deadline() const;
  /// The line was taken down, or leads to another node: nothing that is held back goes onto the new one.
  void line_lost();
  /// Nothing is wrong and nothing is held back: all passes as it comes, so the caller need not ask.
  bool idle() const { return active_.empty() && held_.empty() && ready_.empty() && !on_data_ && !told_cut_; }

  /// The same, and what was held back is through.
  bool at_rest(Time now) const { return idle() && held_.line_free(now); }

  const LineCounters& counters() const { return counters_; }

 private:
  struct Active {
    Id id;
    Fault fault;
    Time from, until;
    std::uint64_t packets_left, after_packets_left, hits;
    std::mt19937_64 random;
    bool waits(Time now) const { return now < from || after_packets_left != 0; }
  };
  /// What the faults do to one packet.
  struct Effect {
    std::optional<Name> damage;
    Duration delay{0};
  };

  void advance(Time now);
  void start(Active& active, Time now);
  bool on(const Active& active, Name name, Time now) const;
  bool cut_now(Time now) const;
  Duration pace(Time now) const;
  Time next_change(const Active& active) const;
  static bool hits(Active& active);
  Effect decide(bool interrupt, Time now);
  void decide_damage(Active& active, bool interrupt, Effect& effect);
  void decide_delay(Active& active, Effect& effect);
  void swallow(const wire::Slice& slice);
  void pass_data(const wire::Slice& slice, Time now);
  void end_data(const wire::Slice& slice, const Effect& effect, Time now);
  void pass_interrupt(const wire::Slice& slice, Time now);
  void count_awaited(wire::ByteView end, Time now);
  void put(wire::SliceKind kind, wire::ByteView bytes, Time due, Time now);
  void put_damaged(const wire::Slice& slice, Time due, Time now);
  void put_cut_short(const wire::Slice& slice, Time due, Time now);

  std::mt19937_64 random_;
  Duration byte_time_;
  std::vector<Active> active_;
  Id next_id_ = 1;
  Time now_{};                      ///< of the last call
  bool told_cut_ = false;           ///< by cut(), the last time
  std::optional<Effect> on_data_;   ///< of the DATP that is passing
  NodeId data_source_{0};           ///< source of that DATP
  std::vector<std::uint8_t> copy_;  ///< its bytes so far, if it is to be duplicated
  HeldSlices held_;
  wire::SliceWriter ready_;  ///< due at once
  LineCounters counters_;
};

}  // namespace limb_ring::fault
