#pragma once

#include "study/analysis/latency.h"
#include "study/analysis/medium.h"

namespace limb_ring::study {

/// Round trips of DATPs of our ring under random load, from the start of sending until the tail is back:
/// what N (T + d) bounds. The wait in the sender's own queue is not in it.
/// @param load payload offered / R
/// @throw std::runtime_error where the ring does not close
Latencies data_round_trips(const Medium& medium, double load, std::uint64_t seed);

/// Round trips of INTPs of our ring, from the CPU's request until they are back, while every node always
/// has a DATP to send and one INTP under way or about to be asked for.
/// @param embed false: they are sent between DATPs only
/// @throw std::runtime_error as above, and where an INTP or DATP is not delivered
Latencies interrupt_round_trips(const Medium& medium, bool embed, std::uint64_t seed);

}  // namespace limb_ring::study
