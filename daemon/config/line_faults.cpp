#include "config/line_faults.h"

#include <algorithm>

#include "wire/packet.h"

namespace limb_ring::fault {

using core::kNever;
using wire::Slice;
using wire::SliceKind;

namespace {

constexpr std::uint64_t kNoLimit = UINT64_MAX;

bool begins(const Slice& slice) { return slice.kind == SliceKind::whole || slice.kind == SliceKind::start; }
bool ends(const Slice& slice) { return slice.kind == SliceKind::whole || slice.kind == SliceKind::end; }

/// Nothing of the packet goes on.
bool swallowed(std::optional<Name> damage) {
  return damage == Name::drop || damage == Name::reorder || damage == Name::cut;
}

Duration half_period(const Fault& fault) { return std::max<Duration>(Duration(fault.every) / 2, Duration{1}); }

}  // namespace

// ---- which there are ------------------------------------------------------------------------

LineFaults::Id LineFaults::begin(const Fault& fault, Time now) {
  advance(now);
  if (fault.name == Name::heal) {
    clear();
    return 0;
  }
  const std::uint64_t seed = fault.seed != 0 ? fault.seed : random_();
  const std::uint64_t packets = fault.packets != 0 ? fault.packets : kNoLimit;
  active_.push_back(
      {next_id_, fault, now + Duration(fault.after), kNever, packets, fault.after_packets, 0, std::mt19937_64(seed)});
  if (fault.after_packets == 0) start(active_.back(), active_.back().from);
  return next_id_++;
}

void LineFaults::start(Active& active, Time now) {
  active.from = std::max(active.from, now);
  if (active.fault.lasts.count() != 0) active.until = active.from + Duration(active.fault.lasts);
}

bool LineFaults::remove(Id id) {
  const auto found = std::find_if(active_.begin(), active_.end(), [&](const Active& a) { return a.id == id; });
  if (found == active_.end()) return false;
  active_.erase(found);
  return true;
}

std::vector<LineFaults::Listed> LineFaults::list(Time now) {
  advance(now);
  std::vector<Listed> all;
  for (const Active& active : active_) all.push_back({active.id, active.fault, active.waits(now), active.hits});
  return all;
}

// What a stall held back goes on when the stall ends, not when somebody next calls.
void LineFaults::advance(Time now) {
  now_ = std::max(now_, now);
  const auto over = [&](const Active& active) {
    if (active.until <= now && active.fault.name == Name::stall) held_.block_until(active.until);
    return active.until <= now || active.packets_left == 0;
  };
  active_.erase(std::remove_if(active_.begin(), active_.end(), over), active_.end());
  if (stalled(now)) held_.block_until(now);
}

bool LineFaults::on(const Active& active, Name name, Time now) const {
  return active.fault.name == name && !active.waits(now) && now < active.until;
}

bool LineFaults::stalled(Time now) const {
  return std::any_of(active_.begin(), active_.end(), [&](const Active& a) { return on(a, Name::stall, now); });
}

bool LineFaults::cut_now(Time now) const {
  return std::any_of(active_.begin(), active_.end(), [&](const Active& a) {
    return on(a, Name::cut, now) || (on(a, Name::flap, now) && (now - a.from) / half_period(a.fault) % 2 == 0);
  });
}

bool LineFaults::cut(Time now) {
  advance(now);
  told_cut_ = cut_now(now);
  if (told_cut_) line_lost();
  return told_cut_;
}

/// The time of a byte where the data rate is limited; 0 if it is not.
Duration LineFaults::pace(Time now) const {
  constexpr std::uint64_t kBitPicoseconds = 8'000'000'000'000;
  Duration slowest{0};
  for (const Active& active : active_)
    if (on(active, Name::rate, now))
      slowest = std::max(slowest, Duration(static_cast<std::int64_t>(kBitPicoseconds / active.fault.rate)));
  return slowest;
}

Time LineFaults::next_change(const Active& active) const {
  if (active.after_packets_left != 0) return kNever;
  if (now_ < active.from) return active.from;
  if (active.fault.name != Name::flap) return active.until;
  const Duration half = half_period(active.fault);
  return std::min(active.until, active.from + ((now_ - active.from) / half + 1) * half);
}

Time LineFaults::next_deadline() const {
  if (!ready_.empty() || cut_now(now_) != told_cut_) return now_;
  Time next = stalled(now_) ? kNever : held_.next(pace(now_));
  for (const Active& active : active_) next = std::min(next, next_change(active));
  return next;
}

void LineFaults::line_lost() {
  counters_.line_lost += held_.count();
  held_.clear();
  if (on_data_) on_data_ = Effect{Name::cut, Duration{0}};  // the rest of that DATP is lost, too
}

// ---- what becomes of a packet ---------------------------------------------------------------

bool LineFaults::hits(Active& active) {
  if (active.packets_left == 0 || active.random() % active.fault.once_in != 0) return false;
  ++active.hits;
  if (active.packets_left != kNoLimit) --active.packets_left;
  return true;
}

LineFaults::Effect LineFaults::decide(bool interrupt, Time now) {
  Effect effect;
  if (held_.bytes() + wire::kMaxSliceSize > kLimit) {
    ++counters_.line_full;
    return {Name::drop, Duration{0}};
  }
  for (Active& active : active_) {
    if (active.waits(now)) continue;
    if (active.fault.name == Name::delay)
      decide_delay(active, effect);
    else
      decide_damage(active, interrupt, effect);
  }
  return effect;
}

// The first fault that hits counts. An INTP is too short to be truncated.
void LineFaults::decide_damage(Active& active, bool interrupt, Effect& effect) {
  std::uint64_t* counter = nullptr;
  switch (active.fault.name) {
    case Name::drop:
      counter = &counters_.line_dropped;
      break;
    case Name::corrupt:
      counter = &counters_.line_corrupted;
      break;
    case Name::truncate:
      counter = interrupt ? nullptr : &counters_.line_truncated;
      break;
    case Name::duplicate:
      counter = &counters_.line_duplicated;
      break;
    case Name::reorder:
      counter = &counters_.line_reordered;
      break;
    default:
      break;
  }
  if (counter == nullptr || effect.damage || !hits(active)) return;
  ++*counter;
  effect.damage = active.fault.name;
}

void LineFaults::decide_delay(Active& active, Effect& effect) {
  if (!hits(active)) return;
  const auto jitter = static_cast<std::uint64_t>(Duration(active.fault.jitter).count());
  effect.delay += active.fault.delay + Duration(static_cast<std::int64_t>(active.random() % (jitter + 1)));
  ++counters_.line_delayed;
}

// ---- slices ---------------------------------------------------------------------------------

void LineFaults::pass(const Slice& slice, Time now) {
  advance(now);
  if (cut_now(now)) return swallow(slice);
  if (slice.kind == SliceKind::interrupt) return pass_interrupt(slice, now);
  if (slice.kind == SliceKind::fold) return put(slice.kind, slice.bytes, now, now);
  if (slice.kind != SliceKind::idle) return pass_data(slice, now);
  // An idle slice behind slices that wait says nothing new, and would fill the memory.
  if (held_.empty() && !stalled(now)) put(slice.kind, slice.bytes, now, now);
}

/// What comes while the line is cut is lost, and so is the rest of a DATP of which a part was lost.
void LineFaults::swallow(const Slice& slice) {
  if (slice.kind == SliceKind::idle || slice.kind == SliceKind::fold) return;
  const bool interrupt = slice.kind == SliceKind::interrupt;
  const bool known = on_data_ && on_data_->damage == Name::cut && !begins(slice);
  if (interrupt || !known) ++counters_.line_cut;
  if (interrupt) return;
  on_data_ = Effect{Name::cut, Duration{0}};
  if (ends(slice) || slice.kind == SliceKind::abort) on_data_.reset();
}

void LineFaults::pass_data(const Slice& slice, Time now) {
  if (begins(slice)) {
    on_data_ = decide(false, now);
    data_source_ = wire::NodeId{slice.bytes[wire::field::kSource]};
    copy_.clear();
  }
  const Effect effect = on_data_.value_or(Effect{});
  if (effect.damage == Name::duplicate) copy_.insert(copy_.end(), slice.bytes.begin(), slice.bytes.end());
  if (ends(slice))
    end_data(slice, effect, now);
  else if (!swallowed(effect.damage))
    put(slice.kind, slice.bytes, now + effect.delay, now);
  if (ends(slice) || slice.kind == SliceKind::abort) on_data_.reset();
}

void LineFaults::end_data(const Slice& slice, const Effect& effect, Time now) {
  const Time due = now + effect.delay;
  if (swallowed(effect.damage)) return;
  if (on_data_) count_awaited(slice.bytes, now);
  if (effect.damage == Name::corrupt) return put_damaged(slice, due, now);
  if (effect.damage == Name::truncate) return put_cut_short(slice, due, now);
  put(slice.kind, slice.bytes, due, now);
  if (effect.damage != Name::duplicate || !wire::slice_size_fits(SliceKind::whole, copy_.size())) return;
  put(SliceKind::whole, {copy_.data(), copy_.size()}, due + byte_time_ * static_cast<std::int64_t>(copy_.size()), now);
}

void LineFaults::pass_interrupt(const Slice& slice, Time now) {
  const Effect effect = decide(true, now);
  const Time due = now + effect.delay;
  if (effect.damage == Name::reorder && on_data_ && !swallowed(on_data_->damage)) {
    ++counters_.line_aborted;
    put(SliceKind::abort, {}, now + on_data_->delay, now);
    on_data_->damage = Name::reorder;
  }
  if (swallowed(effect.damage)) return;
  if (effect.damage == Name::corrupt) return put_damaged(slice, due, now);
  put(slice.kind, slice.bytes, due, now);
  if (effect.damage == Name::duplicate)
    put(slice.kind, slice.bytes, due + byte_time_ * static_cast<std::int64_t>(slice.bytes.size), now);
}

// A fault that waits for this packet (after_packets) hits the next one, not this one.
void LineFaults::count_awaited(wire::ByteView end, Time now) {
  const std::uint8_t last = end[end.size - wire::kCrcSize - 1];
  if (wire::channel_of(last) == static_cast<std::uint8_t>(wire::Channel::control)) return;
  for (Active& active : active_)
    if (active.after_packets_left != 0 && active.fault.of == data_source_ && --active.after_packets_left == 0)
      start(active, now);
}

// Passes a slice straight on if nothing is in its way, so that a line with only a rare fault costs little.
void LineFaults::put(SliceKind kind, wire::ByteView bytes, Time due, Time now) {
  const bool straight = due <= now && held_.empty() && held_.line_free(now) && !stalled(now) && pace(now).count() == 0;
  if (straight) return ready_.put(kind, bytes);
  const bool packet = kind == SliceKind::start || kind == SliceKind::whole || kind == SliceKind::interrupt;
  if (packet && due <= now) ++counters_.line_held;
  held_.put(kind, bytes, due);
}

// Never in the header: it would be no packet any more, or one of another source, and nobody would count it as damaged.
void LineFaults::put_damaged(const Slice& slice, Time due, Time now) {
  std::vector<std::uint8_t> bytes(slice.bytes.begin(), slice.bytes.end());
  const std::size_t size = bytes.size() - (begins(slice) || slice.kind == SliceKind::interrupt ? wire::kHeaderSize : 0);
  const std::uint64_t bit = random_() % (8 * size);
  bytes[bytes.size() - 1 - bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
  put(slice.kind, {bytes.data(), bytes.size()}, due, now);
}

/// Of a `whole`, passes on the header and the whole words of data as a `start`. Then comes an abort.
void LineFaults::put_cut_short(const Slice& slice, Time due, Time now) {
  if (slice.kind == SliceKind::whole) {
    const std::size_t words = (slice.bytes.size - wire::kOverhead) / 4;
    put(SliceKind::start, slice.bytes.first(wire::kHeaderSize + 4 * words), due, now);
  }
  put(SliceKind::abort, {}, due, now);
}

void LineFaults::take(Time now, wire::SliceWriter& out) {
  advance(now);
  out.take(ready_);
  if (cut_now(now)) return line_lost();
  if (stalled(now)) return;
  for (const Duration slower = pace(now); held_.next(slower) <= now;) held_.take(slower, out);
}

}  // namespace limb_ring::fault
