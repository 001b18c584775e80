#pragma once

#include <cstdint>

#include "io/link_header.h"
#include "io/seal.h"

namespace limb_ring::link {

/// What is counted at the receiving end of a link: (name, what one count means).
#define LIMB_RING_INPUT_COUNTERS(X)                                              \
  X(reads, "read from the socket or the shared memory")                          \
  X(bytes, "byte read")                                                          \
  X(slices, "slice other than idle")                                             \
  X(idle_slices, "idle")                                                         \
  X(beats, "shared memory: tick at which the writer had said that it lives")     \
  X(connects, "upstream neighbour that came")                                    \
  X(losses, "upstream neighbour that went, for whatever reason")                 \
  X(silences, "of those: silent for too long")                                   \
  X(given_up, "of those: by others, while this process or its host stood still") \
  X(replaced, "of those: a nearer or newer one came")                            \
  X(refused, "connect of our ring that we refused as busy")                      \
  X(unknown_peers, "garbage, another ring, another user, half-open connection")  \
  X(other_version, "of those: another version of the protocol")                  \
  X(other_ring_file, "of those: another ring file")                              \
  X(other_key, "of those: no key, or another one")                               \
  X(malformed, "stream or datagram that held no slice")                          \
  X(datagrams, "datagram")                                                       \
  X(datagrams_duplicate, "lower or equal sequence: doubled or overtaken")        \
  X(datagrams_lost, "missing from the sequence")                                 \
  X(datagrams_stale, "of our ring, of no session we have")                       \
  X(offers, "connect over UDP that was answered with a session")                 \
  X(datagrams_truncated, "keyed: too short for what it says it is")              \
  X(datagrams_forged, "keyed: no tag that our key makes for these bytes")        \
  X(datagrams_replayed, "keyed: authentic, and seen before, or too old to tell") \
  X(delay_dropped, "slice that did not fit the delay line")                      \
  X(queue_invalid, "line that ended since the writer's end of the shared memory was invalid")

/// The same at its sending end.
#define LIMB_RING_OUTPUT_COUNTERS(X)                                              \
  X(writes, "write to the socket or the shared memory")                           \
  X(bytes, "byte given to it")                                                    \
  X(idle_slices, "idle, or beat through shared memory")                           \
  X(blocked, "write that the socket did not take at once")                        \
  X(discarded, "byte given or waiting while the link was gone")                   \
  X(datagrams, "datagram sent")                                                   \
  X(datagrams_unsent, "datagram for which the kernel had no room, or no route")   \
  X(datagrams_truncated, "keyed, of what comes back: as at the receiving end")    \
  X(datagrams_forged, "keyed, of what comes back: as at the receiving end")       \
  X(datagrams_replayed, "keyed, of what comes back: as at the receiving end")     \
  X(attempts, "connection tried")                                                 \
  X(refused, "of those: answered with a refusal")                                 \
  X(other_version, "of those: it speaks another version of the protocol")         \
  X(other_ring_file, "of those: it runs another ring file")                       \
  X(other_key, "of those: it has no key, or another one")                         \
  X(connects, "downstream neighbour won")                                         \
  X(losses, "downstream neighbour lost, for whatever reason")                     \
  X(silences, "of those: silent for too long (dead or frozen)")                   \
  X(queue_invalid, "of those: the reader's end of the shared memory was invalid") \
  X(queue_unavailable, "attempt for which the kernel gave no shared memory")

#define LIMB_RING_LINK_COUNTER_MEMBER(name, meaning) std::uint64_t name = 0;
#define LIMB_RING_LINK_COUNTER_VISIT(name, meaning) visit(#name, meaning, name);

/// Since the start.
struct InputCounters {
  LIMB_RING_INPUT_COUNTERS(LIMB_RING_LINK_COUNTER_MEMBER)
  std::uint8_t last_stale_from = 0;  ///< as the last such datagram says

  /// Calls visit(name, meaning, value) for each, in the order above.
  template <class Visit>
  void each(Visit visit) const {
    LIMB_RING_INPUT_COUNTERS(LIMB_RING_LINK_COUNTER_VISIT)
  }
};

/// Since the start.
struct OutputCounters {
  LIMB_RING_OUTPUT_COUNTERS(LIMB_RING_LINK_COUNTER_MEMBER)

  /// As InputCounters::each().
  template <class Visit>
  void each(Visit visit) const {
    LIMB_RING_OUTPUT_COUNTERS(LIMB_RING_LINK_COUNTER_VISIT)
  }
};

#undef LIMB_RING_LINK_COUNTER_MEMBER
#undef LIMB_RING_LINK_COUNTER_VISIT

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

}  // namespace limb_ring::link
