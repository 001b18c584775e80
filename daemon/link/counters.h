#pragma once

#include <cstdint>

#include "link/link_header.h"
#include "link/seal.h"

namespace limb_ring::link {

/// What happened at the receiving end of a link since the start.
struct InputCounters {
  std::uint64_t reads = 0, bytes = 0, slices = 0, idle_slices = 0;
  std::uint64_t beats = 0;            ///< shared memory: ticks at which the writer had said that it lives
  std::uint64_t connects = 0;         ///< upstream neighbours that came
  std::uint64_t losses = 0;           ///< upstream neighbours that went, for whatever reason
  std::uint64_t silences = 0;         ///< of those: silent for too long
  std::uint64_t given_up = 0;         ///< of those: by the neighbour, while this process stood still
  std::uint64_t replaced = 0;         ///< of those: a nearer or newer one came
  std::uint64_t refused = 0;          ///< connects of our ring that we refused
  std::uint64_t unknown_peers = 0;    ///< garbage, other rings, other users, half-open connections
  std::uint64_t other_version = 0;    ///< of those: another version of the protocol
  std::uint64_t other_ring_file = 0;  ///< of those: another ring file
  std::uint64_t other_key = 0;        ///< of those: no key, or another one
  std::uint64_t malformed = 0;        ///< streams or datagrams that held no slice
  std::uint64_t datagrams = 0;
  std::uint64_t datagrams_duplicate = 0;  ///< lower or equal sequence: doubled or overtaken
  std::uint64_t datagrams_lost = 0;       ///< missing from the sequence
  std::uint64_t datagrams_stale = 0;      ///< of our ring, of no session we have
  std::uint64_t offers = 0;               ///< connects over UDP that were answered with a session
  std::uint64_t datagrams_truncated = 0;  ///< keyed: too short for what it says it is
  std::uint64_t datagrams_forged = 0;     ///< keyed: no tag that our key makes for these bytes
  std::uint64_t datagrams_replayed = 0;   ///< keyed: authentic, and seen before, or too old to tell
  std::uint64_t delay_dropped = 0;        ///< slices that did not fit the delay line
  std::uint64_t queue_invalid = 0;        ///< lines ended since the writer's end of the shared memory was invalid
};

/// What happened at the sending end of a link since the start.
struct OutputCounters {
  std::uint64_t writes = 0, bytes = 0;
  std::uint64_t idle_slices = 0;  ///< or beats, through shared memory
  std::uint64_t blocked = 0;      ///< writes the socket did not take at once
  std::uint64_t discarded = 0;    ///< bytes given or waiting while the link was gone
  std::uint64_t datagrams = 0;
  std::uint64_t datagrams_unsent = 0;     ///< the kernel had no room, or no route
  std::uint64_t datagrams_truncated = 0;  ///< keyed, of what comes back: as at the receiving end
  std::uint64_t datagrams_forged = 0;
  std::uint64_t datagrams_replayed = 0;
  std::uint64_t attempts = 0;           ///< connections tried
  std::uint64_t refused = 0;            ///< of those: answered with a refusal
  std::uint64_t other_version = 0;      ///< of those: it speaks another version of the protocol
  std::uint64_t other_ring_file = 0;    ///< of those: it runs another ring file
  std::uint64_t other_key = 0;          ///< of those: it has no key, or another one
  std::uint64_t connects = 0;           ///< downstream neighbours won
  std::uint64_t losses = 0;             ///< downstream neighbours lost, for whatever reason
  std::uint64_t silences = 0;           ///< of those: silent for too long (dead or frozen)
  std::uint64_t queue_invalid = 0;      ///< of those: the reader's end of the shared memory was invalid
  std::uint64_t queue_unavailable = 0;  ///< attempts for which the kernel gave no shared memory
};

/// Counts a refusal, given or got, for one of the reasons that people have to mend.
template <typename Counters>
void count(Refusal refusal, Counters& counters) {
  if (refusal == Refusal::wrong_version) ++counters.other_version;
  if (refusal == Refusal::other_ring_file) ++counters.other_ring_file;
  if (of_keys(refusal)) ++counters.other_key;
}

/// Counts a datagram of a keyed session that is not good; its size was looked at before.
template <typename Counters>
void count(Opener::Verdict verdict, Counters& counters) {
  if (verdict == Opener::Verdict::forged) ++counters.datagrams_forged;
  if (verdict == Opener::Verdict::replayed) ++counters.datagrams_replayed;
}

/// Calls visit(name, value) for every counter.
template <typename Visit>
void for_each_counter(const InputCounters& c, Visit&& visit) {
  visit("reads", c.reads);
  visit("bytes", c.bytes);
  visit("slices", c.slices);
  visit("idle_slices", c.idle_slices);
  visit("beats", c.beats);
  visit("connects", c.connects);
  visit("losses", c.losses);
  visit("silences", c.silences);
  visit("given_up", c.given_up);
  visit("replaced", c.replaced);
  visit("refused", c.refused);
  visit("unknown_peers", c.unknown_peers);
  visit("other_version", c.other_version);
  visit("other_ring_file", c.other_ring_file);
  visit("other_key", c.other_key);
  visit("malformed", c.malformed);
  visit("datagrams", c.datagrams);
  visit("datagrams_duplicate", c.datagrams_duplicate);
  visit("datagrams_lost", c.datagrams_lost);
  visit("datagrams_stale", c.datagrams_stale);
  visit("offers", c.offers);
  visit("datagrams_truncated", c.datagrams_truncated);
  visit("datagrams_forged", c.datagrams_forged);
  visit("datagrams_replayed", c.datagrams_replayed);
  visit("delay_dropped", c.delay_dropped);
  visit("queue_invalid", c.queue_invalid);
}

template <typename Visit>
void for_each_counter(const OutputCounters& c, Visit&& visit) {
  visit("writes", c.writes);
  visit("bytes", c.bytes);
  visit("idle_slices", c.idle_slices);
  visit("blocked", c.blocked);
  visit("discarded", c.discarded);
  visit("datagrams", c.datagrams);
  visit("datagrams_unsent", c.datagrams_unsent);
  visit("datagrams_truncated", c.datagrams_truncated);
  visit("datagrams_forged", c.datagrams_forged);
  visit("datagrams_replayed", c.datagrams_replayed);
  visit("attempts", c.attempts);
  visit("refused", c.refused);
  visit("other_version", c.other_version);
  visit("other_ring_file", c.other_ring_file);
  visit("other_key", c.other_key);
  visit("connects", c.connects);
  visit("losses", c.losses);
  visit("silences", c.silences);
  visit("queue_invalid", c.queue_invalid);
  visit("queue_unavailable", c.queue_unavailable);
}

}  // namespace limb_ring::link
