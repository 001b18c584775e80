#pragma once

#include <cstdint>
#include <optional>

#include "wire/packet.h"

/// What network controllers tell each other: the data of broadcast DATPs on channel 1. (ours, protocol.md sections 3.8
/// and 3.9)
namespace limb_ring::wire {

/// A node's first words after a start, or before its numbers start again at 0: "forget what you remember of me".
///
///   | type 1 | boot number 64 | remembers 8 |      10 bytes
struct Hello {
  std::uint64_t boot = 0;  ///< never repeats for one node id
  /// False: it starts, and has forgotten the others. True: only its own sequence numbers start again at 0.
  bool remembers = false;
};
constexpr std::size_t kHelloSize = 10;

enum class CpuState : std::uint8_t { none, absent, booting, running, silent, failed };
/// folded: the second line stands for the line (ours; fold-back, protocol.md section 8.7).
enum class LinkState : std::uint8_t { down, up, silent, folded };
const char* to_string(CpuState state);
const char* to_string(LinkState state);

/// A node's clock at the moment when its sync pin was pulled.
struct ClockLatch {
  std::uint32_t count = 0;     ///< latches since the node's start; 0: none yet
  NodeId source{0};            ///< who asked for the last one
  std::uint64_t clock_ns = 0;  ///< CLOCK_MONOTONIC of the node, ns

  template <class Archive>
  void archive(Archive& a) {
    a("count", count)("source", source)("clock_ns", clock_ns);
  }
};

/// Sent every 100 ms by default, and at once on most changes (protocol.md section 8.2).
///
///   | type 2 | boot 64 | CPU boots 32 | CPU state 8 | CPU silent for, ms 32 | input state 8 |
///   | input from 8 | output state 8 | output to 8 | break known 8 | before 8 | behind 8 |
///   | CPU comes back 8 |                                                    26 bytes
///
/// and behind it, where a stop or a clock is latched:
///
///   | stop latched 8 | clock latches 32 | source of the last one 8 | its clock, ns 64 |   40 bytes
struct Beacon {
  std::uint64_t boot = 0;
  std::uint32_t cpu_boots = 0;  ///< starts of the CPU so far
  CpuState cpu_state = CpuState::none;
  std::uint32_t cpu_silent_ms = 0;  ///< since the CPU last spoke
  LinkState input = LinkState::down;
  NodeId input_from{0};  ///< meaningful where input is not down
  LinkState output = LinkState::down;
  NodeId output_to{0};
  bool break_known = false;  ///< the line from break_before to break_behind is broken
  NodeId break_before{0};
  NodeId break_behind{0};
  bool cpu_comes_back = true;  ///< somebody starts the CPU again when a reset kills it
  bool stop_latched = false;   ///< the CPU says that it has stopped, and has not been resumed
  ClockLatch latch;

  template <class Archive>
  void archive(Archive& a) {
    a("boot", boot)("cpu_boots", cpu_boots)("cpu_state", cpu_state)("cpu_silent_ms", cpu_silent_ms)("input", input);
    a("input_from", input_from)("output", output)("output_to", output_to)("break_known", break_known);
    a("break_before", break_before)("break_behind", break_behind)("cpu_comes_back", cpu_comes_back);
    a("stop_latched", stop_latched)("latch", latch);
  }
};
constexpr std::size_t kBeaconSize = 26, kLongBeaconSize = 40;

/// After so many missed beacons, or repeated fold words, their sender is gone, or beyond a second break. (ours)
constexpr int kMissedBeacons = 5;

/// @param out room for kHelloSize bytes for a hello, kLongBeaconSize for a beacon. @return bytes written
std::size_t encode(const Hello& hello, std::uint8_t* out);
std::size_t encode(const Beacon& beacon, std::uint8_t* out);

/// @return nothing where the bytes are no such message
std::optional<Hello> decode_hello(ByteView data);
std::optional<Beacon> decode_beacon(ByteView data);

}  // namespace limb_ring::wire
