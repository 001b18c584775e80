#include "wire/earlier_tries.h"

namespace limb_ring::capture {

namespace {

/// A second, and what a living ring may be late.
constexpr std::chrono::milliseconds kSentAgainFor{1100};

wire::Code code_of(const EarlierTries::Try& one) { return wire::code_of(one.seen.code); }

}  // namespace

std::optional<std::size_t> EarlierTries::before(const Try& now) {
  const Known* found = code_of(now).attempt > 0 ? try_before(now) : refused_before(now);
  const bool goes_on = found != nullptr && found->tried.end == TripEnd::refused;
  const std::optional<std::size_t> index = found == nullptr ? std::nullopt : std::optional(found->index);
  remember({now, count_++, goes_on ? found->refused_since : now.ended});
  return index;
}

void EarlierTries::remember(const Known& known) {
  const SeenPacket& seen = known.tried.seen;
  std::map<std::uint8_t, Known>& tries = by_try_[{seen.source, seen.interrupt()}];
  const std::uint8_t attempt = code_of(known.tried).attempt;
  if (attempt == 0 ||
      (!tries.empty() && code_of(tries.begin()->second.tried).sequence != code_of(known.tried).sequence))
    tries.clear();
  tries.insert_or_assign(attempt, known);
  if (seen.trailer && !seen.interrupt())
    by_route_.insert_or_assign({seen.source, seen.trailer->destination, seen.trailer->last}, known);
}

const EarlierTries::Known* EarlierTries::try_before(const Try& now) const {
  const auto tries = by_try_.find({now.seen.source, now.seen.interrupt()});
  if (tries == by_try_.end()) return nullptr;
  wire::Code code = code_of(now);
  --code.attempt;
  const auto found = tries->second.find(code.attempt);
  if (found == tries->second.end()) return nullptr;
  const SeenPacket& seen = found->second.tried.seen;
  return seen.code == code.byte() && seen.may_be(now.seen) ? &found->second : nullptr;
}

const EarlierTries::Known* EarlierTries::refused_before(const Try& now) const {
  const std::optional<SeenPacket::Trailer>& trailer = now.seen.trailer;
  if (!trailer || now.seen.interrupt() || trailer->destination == wire::kBroadcast) return nullptr;
  const auto found = by_route_.find({now.seen.source, trailer->destination, trailer->last});
  if (found == by_route_.end()) return nullptr;
  const Known& known = found->second;
  const bool next = code_of(now).sequence == ((code_of(known.tried).sequence + 1) & 7);
  const bool again = known.tried.end == TripEnd::refused && next && known.tried.seen.may_be(now.seen) &&
                     now.began - known.refused_since <= kSentAgainFor;
  return again ? &known : nullptr;
}

}  // namespace limb_ring::capture
