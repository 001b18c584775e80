#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/ring_order.h"
#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::core {

using wire::NodeId;

/// An interrupt input of the NC: pulling it sends this INTP, without the CPU. (paper)
struct InterruptInput {
  NodeId destination{0};
  wire::Factor factor{};

  template <class Archive>
  void archive(Archive& a) {
    a("destination", destination)("factor", factor);
  }
};

/// What one network controller is told at its start.
struct Settings {
  NodeId id{0};
  RingOrder order{NodeId{0}};  ///< all configured nodes in ring order, this one among them
  std::uint64_t boot = 1;      ///< first boot number; must be higher than any used before

  Duration byte_time_out{0};  ///< of the output line; 0: as fast as it takes them
  Duration byte_time_in{0};   ///< of the input line
  Duration relay_delay{0};    ///< d of protocol.md section 7.1; only time-outs use it here

  /// Worst lap of the whole ring if its lines differ; 0: nodes() times the own line's T + d.
  Duration lap{0};
  /// Sum of the d of all nodes, if they differ; 0: nodes() times the own relay_delay.
  Duration all_delays{0};

  unsigned insertion_buffer = 8;   ///< DATPs of the largest size, at least 2
  unsigned interrupt_buffer = 64;  ///< INTPs
  unsigned send_queue = 64;        ///< sends per priority, and interrupts
  unsigned receive_buffers = 32;   ///< DATPs per priority

  Duration send_timeout_least = std::chrono::milliseconds(100);
  Duration refused_for = std::chrono::seconds(1);
  Duration refused_backoff = std::chrono::milliseconds(1);
  Duration refused_backoff_most = std::chrono::milliseconds(64);
  Duration queue_timeout = std::chrono::seconds(5);
  Duration stall = std::chrono::milliseconds(50);
  Duration beacon = std::chrono::milliseconds(100);            ///< 0: no beacons
  Duration break_grace = std::chrono::milliseconds(200);       ///< input lost so long: a broken line
  Duration fold_permission = std::chrono::milliseconds(200);   ///< after its start; then a node may fold in any case
  Duration unconfirmed_pace = std::chrono::microseconds(100);  ///< open chain: least time between two of a kind

  /// Embeds INTPs into a DATP that is on its way out (paper); false only to show what that is worth.
  bool embed_interrupts = true;

  bool fold_back = false;      ///< there is a second, counter-rotating line (ours)
  bool several_hosts = false;  ///< nodes of one host may lose those of the others, and close a ring without them (ours)

  std::array<bool, wire::kFactors> wired{};  ///< pins wired to something
  std::array<std::optional<InterruptInput>, wire::kFactors> inputs{};

  template <class Archive>
  void archive(Archive& a) {
    a("id", id)("order", order)("boot", boot)("byte_time_out", byte_time_out)("byte_time_in", byte_time_in);
    a("relay_delay", relay_delay)("lap", lap)("all_delays", all_delays)("insertion_buffer", insertion_buffer);
    a("interrupt_buffer", interrupt_buffer)("send_queue", send_queue)("receive_buffers", receive_buffers);
    a("send_timeout_least", send_timeout_least)("refused_for", refused_for)("refused_backoff", refused_backoff);
    a("refused_backoff_most", refused_backoff_most)("queue_timeout", queue_timeout)("stall", stall)("beacon", beacon);
    a("break_grace", break_grace)("fold_permission", fold_permission)("unconfirmed_pace", unconfirmed_pace);
    a("embed_interrupts", embed_interrupts)("fold_back", fold_back)("several_hosts", several_hosts);
    a("wired", wired)("inputs", inputs);
  }

  /// Two parts of the ring may each be a closed ring for a while, and number on; then they grow together again: two
  /// breaks if it folds back, or hosts that lose each other. (ours, protocol.md section 4.10)
  bool falls_into_parts() const { return fold_back || several_hosts; }
  unsigned nodes() const { return static_cast<unsigned>(order.size()); }
  /// One lap of largest packets in the worst case: N * (T + d), INTPs cutting in once per node.
  Duration worst_lap() const {
    if (lap.count() != 0) return lap;
    return nodes() *
           (byte_time_out * static_cast<int>(wire::kMaxDataPacketSize + wire::kInterruptPacketSize) + relay_delay);
  }
  /// Least time between two packets of a kind in an open chain, if no return says when.
  Duration open_chain_pace() const { return std::max(worst_lap(), unconfirmed_pace); }
  Duration open_chain_interrupt_pace() const {
    return std::max(nodes() * (byte_time_out * static_cast<int>(2 * wire::kInterruptPacketSize) + relay_delay),
                    unconfirmed_pace);
  }
  /// Time-out of one try: two laps, and never less than send_timeout_least. In a ring that folds back a lap includes
  /// the second line's delays even while nothing is folded: a packet may leave before a fold. (ours)
  Duration send_timeout() const { return std::max(send_timeout_least, 2 * (worst_lap() + second_line_lap())); }
  /// Where the ring falls into parts: a try of a packet leaves no later than that after the first one. (ours)
  Duration tries_last() const { return wire::kTries * send_timeout(); }
  Duration second_line_lap() const {
    if (!fold_back) return Duration{0};
    return all_delays.count() != 0 ? all_delays : nodes() * relay_delay;
  }
};

}  // namespace limb_ring::core
