#pragma once

namespace limb_ring::core {

/// Ways in which the core is broken on purpose; break_core puts them into a copy of its sources.
enum class Mutation {
  none,
  result_twice,         ///< a send tells its result twice
  says_delivered,       ///< what nobody took is called delivered
  takes_damaged,        ///< the CRC is not looked at
  forgets_duplicates,   ///< a retry is taken a second time
  refused_goes_last,    ///< what is refused lets others of its priority pass
  holds_interrupts,     ///< an INTP waits for the end of the DATP on the line
  does_not_wait,        ///< a node sends its next DATP before the last is back
  passes_orphans,       ///< packets whose source is gone are passed on
  lies_in_fbc,          ///< FBC says taken where it was refused
  sends_lowest_first,   ///< of what waits, the lowest priority goes first
  gives_lowest_first,   ///< the CPU gets the lowest priority first
  misses_broadcasts,    ///< odd nodes never take a broadcast
  refuses_every_tenth,  ///< every tenth packet is refused though a buffer is free
  short_round_trips,    ///< results tell of round trips of a picosecond
  counts_one_try,       ///< results tell of one try, however many there were
  gives_up_early,       ///< a send is lost after two tries
  gives_up_at_beacons,  ///< what is out to a node that sends a beacon is not repeated, as if it had started again
  refused_at_once,      ///< what is refused does not go again
  full_too_early,       ///< a queue is full with two sends
  cancels_nothing,      ///< the sends of a CPU that was reset go on
  never_heals,          ///< a node stays in the open chain though its beacon has come home
  repeats_unasked,      ///< the second line is repeated though no fold is known
  forgets_last,         ///< a node that sends on the first line again does not say so on the second
  hides_deafness,       ///< a node that hears nothing on the first line does not say so
  takes_at_once         ///< the first line is taken before what is on the second has come
};

inline Mutation mutation = Mutation::none;
inline bool broken(Mutation which) { return mutation == which; }

}  // namespace limb_ring::core
