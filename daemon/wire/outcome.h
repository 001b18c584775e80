#pragma once

#include <cstddef>
#include <cstdint>

namespace limb_ring::wire {

/// How a send ended; every send has exactly one. (ours, protocol.md section 4.6) Core and client library both use
/// these values and words; limb_ring/host_port.h repeats the values, since a public header includes nothing of ours.
enum class Outcome : std::uint8_t { delivered, refused, no_such_node, lost, unconfirmed, rejected, cancelled };
constexpr std::size_t kOutcomes = static_cast<std::size_t>(Outcome::cancelled) + 1;

/// One or three words: "no such node".
constexpr const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::delivered:
      return "delivered";
    case Outcome::refused:
      return "refused";
    case Outcome::no_such_node:
      return "no such node";
    case Outcome::lost:
      return "lost";
    case Outcome::unconfirmed:
      return "unconfirmed";
    case Outcome::rejected:
      return "rejected";
    case Outcome::cancelled:
      return "cancelled";
  }
  return "unknown outcome";
}

}  // namespace limb_ring::wire
