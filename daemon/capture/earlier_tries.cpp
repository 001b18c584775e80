#include "capture/earlier_tries.h"

namespace limb_ring::capture {

std::optional<std::size_t> EarlierTries::before(const SeenPacket& first,
                                                const std::optional<SeenPacket::Trailer>& trailer, WayEnd end) {
  const bool retry = wire::code_of(first.code).attempt > 0;
  const std::optional<std::size_t> found = retry ? try_before(first, trailer) : refused_before(first, trailer);
  Try now{count_++, std::nullopt, end};
  if (trailer) now.destination = trailer->destination;
  by_code_.insert_or_assign({first.source, first.code}, now);
  if (trailer && !first.interrupt())
    by_route_.insert_or_assign({first.source, trailer->destination, trailer->last}, now);
  return found;
}

std::optional<std::size_t> EarlierTries::try_before(const SeenPacket& first,
                                                    const std::optional<SeenPacket::Trailer>& trailer) const {
  wire::Code code = wire::code_of(first.code);
  --code.attempt;
  const auto tried = by_code_.find({first.source, code.byte()});
  if (tried == by_code_.end()) return std::nullopt;
  const bool elsewhere = trailer && tried->second.destination && *tried->second.destination != trailer->destination;
  if (elsewhere) return std::nullopt;
  return tried->second.index;
}

std::optional<std::size_t> EarlierTries::refused_before(const SeenPacket& first,
                                                        const std::optional<SeenPacket::Trailer>& trailer) const {
  if (!trailer || first.interrupt() || trailer->destination == wire::kBroadcast) return std::nullopt;
  const auto sent = by_route_.find({first.source, trailer->destination, trailer->last});
  if (sent == by_route_.end() || sent->second.end != WayEnd::refused) return std::nullopt;
  return sent->second.index;
}

}  // namespace limb_ring::capture
