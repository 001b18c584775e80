#include "ring/error_counters.h"

namespace limb_ring::ask {

const std::vector<ErrorCounter>& error_counters() {
  using Of = ErrorCounter::Of;
  static const std::vector<ErrorCounter> counters{
      {Of::input, "crc_errors", true},
      {Of::input, "malformed_packets", true},
      {Of::input, "stray_slices", false},
      {Of::input, "oversize_packets", true},
      {Of::input, "stalled_packets", true},
      {Of::input, "broken_off_packets", true},
      {Of::input, "input_losses", false},
      {Of::input, "input_malformed", false},
      {Of::input, "input_datagrams_lost", true},  // each held packets, or a part of one
      {Of::input, "input_datagrams_duplicate", false},
      {Of::input, "input_delay_dropped", false},
      {Of::output, "output_losses", false},
      {Of::output, "output_discarded", false},
      {Of::output, "output_datagrams_unsent", false},
      {Of::output, "dropped_no_output", true},
      {Of::node, "ended_lost", true},
      {Of::node, "ended_refused", false},
      {Of::node, "timeouts", true},
      {Of::node, "returns_damaged", true},
      {Of::node, "returns_unmatched", false},
      {Of::node, "refused_no_buffer", false},
      {Of::node, "insertion_buffer_full", true},
      {Of::node, "interrupt_buffer_full", true},
      {Of::node, "flushed_on_reset", false},
      {Of::node, "orphans_hop", false},
      {Of::node, "duplicate_id_signs", false},
      {Of::node, "host_slow_clients", false},
      {Of::node, "host_interrupts_lost", false},
  };
  return counters;
}

}  // namespace limb_ring::ask
