#include "limb_ring/reason.h"

#include <array>

namespace limb_ring {

namespace {

struct Words {
  const char* word;
  const char* sentence;
};

/// In the order of Reason.
constexpr std::array<Words, static_cast<std::size_t>(kLastReason) + 1> kWords{{
    {"", ""},
    {"bad_size", "a packet carries 1 to 512 bytes"},
    {"bad_destination", "no node of that id is configured"},
    {"bad_priority", "priorities are 0 (highest) to 3"},
    {"bad_channel", "channels are 0 to 63, and 1 is the network controllers' own"},
    {"bad_factor", "interrupt factors are 0 to 7"},
    {"input_unwired", "this interrupt input is wired to nothing"},
    {"queue_full", "the send queue is full"},
    {"not_in_ring", "the node that was to send is not in a ring"},
    {"no_way_out", "the packet could not go onto the line in time"},
    {"needs_force", "it would reset all CPUs at once; with --force (force: true in ROS) it is sent all the same"},
    {"cpu_absent", "no CPU is there"},
    {"cpu_booting", "its CPU is booting"},
    {"cpu_failed", "its CPU has failed"},
    {"cpu_silent", "its CPU hangs and its receive buffers are full"},
    {"no_buffer", "its receive buffers are full: its CPU takes packets too slowly"},
    {"joining", "it is joining the ring"},
    {"pin_unwired", "that pin is wired to nothing"},
    {"node_missing", "it is not in the ring now: down, or bypassed"},
    {"no_return", "no try came home whole in time; it may have arrived, at most once"},
    {"open_chain", "the ring is open, so nothing returns; it may have arrived"},
    {"out_of_reach", "the ring is open, and it lies before the node that sent: it was not reached"},
    {"given_up", "given up: its CPU was reset, or the sender or its daemon went away"},
}};

const Words& words_of(Reason reason) {
  const auto index = static_cast<std::size_t>(reason);
  return kWords[index < kWords.size() ? index : 0];
}

}  // namespace

const char* to_string(Reason reason) { return words_of(reason).word; }
const char* sentence(Reason reason) { return words_of(reason).sentence; }

}  // namespace limb_ring
