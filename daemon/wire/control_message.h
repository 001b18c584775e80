#pragma once

#include <cstdint>
#include <optional>

#include "wire/packet.h"
#include "wire/slice.h"

/// What network controllers tell each other: hello and beacon, the data of broadcast DATPs on channel 1, and the words
/// of a ring that folds back. (ours, protocol.md sections 3.8, 3.9 and 8.8)
///
/// Each has one list of its fields, in the order of their bytes, a row for each: type, name, initial value, then what
/// `Field` says. From it come the struct, the codec, what is archived, what is news, the members of `heard` in a status
/// row, the words of `ringctl traffic show`, the dissector, and the tables of docs/protocol.md
/// (docs/generate_reference.py writes these two). A field added is one row.
namespace limb_ring::wire {

/// What is to be known of a field but its value.
struct Field {
  const char* name;
  const char* title;            ///< on the page
  const char* value;            ///< on the page: what it says
  bool news = false;            ///< others tell their CPUs at once that it has changed (PeerChanged)
  const char* heard = nullptr;  ///< what a status row says of it in `heard`; null: it is not there under its name
};
constexpr bool kNews = true, kNoNews = false;

#define LIMB_RING_FIELD(type, name, initial, ...) type name = initial;
#define LIMB_RING_VISIT_FIELD(type, name, initial, ...) visit(&Self::name, Field{#name, __VA_ARGS__});
/// All members of a list, and a function that calls visit(pointer to member, Field) for each.
#define LIMB_RING_FIELDS(each, LIST)               \
  LIST(LIMB_RING_FIELD)                            \
  template <class Visit>                           \
  static constexpr void each(const Visit& visit) { \
    LIST(LIMB_RING_VISIT_FIELD)                    \
  }

enum class CpuState : std::uint8_t { none, absent, booting, running, silent, failed };
/// folded: the second line stands for the line (ours; fold-back, protocol.md section 8.7).
enum class LinkState : std::uint8_t { down, up, silent, folded };
constexpr const char* to_string(CpuState state) {
  switch (state) {
    case CpuState::none:
      return "none";
    case CpuState::absent:
      return "absent";
    case CpuState::booting:
      return "booting";
    case CpuState::running:
      return "running";
    case CpuState::silent:
      return "silent";
    case CpuState::failed:
      return "failed";
  }
  return "unknown";
}

constexpr const char* to_string(LinkState state) {
  switch (state) {
    case LinkState::down:
      return "down";
    case LinkState::up:
      return "up";
    case LinkState::silent:
      return "silent";
    case LinkState::folded:
      return "folded";
  }
  return "unknown";
}

#define LIMB_RING_HELLO(X)                        \
  X(std::uint64_t, boot, 0, "boot number", "4.8") \
  X(bool, remembers, false, "remembers",          \
    "0: the node starts and has forgotten the others; 1: only its own sequence numbers begin at 0 again")
/// A node's first words after a start, or before its numbers start again at 0: "forget what you remember of me".
struct Hello {
  using Self = Hello;
  LIMB_RING_FIELDS(fields, LIMB_RING_HELLO)
};

#define LIMB_RING_CLOCK_LATCH(X)                                                             \
  X(std::uint32_t, count, 0, "clock latches",                                                \
    "how often the pin for that was pulled since the start; 0: the next two are 0 as well")  \
  X(NodeId, source, NodeId{0}, "latch source", "id of the node that asked for the last one") \
  X(std::uint64_t, clock_ns, 0, "latched clock", "CLOCK_MONOTONIC of the node at that moment, ns")
/// A node's clock at the moment when its sync pin was pulled.
struct ClockLatch {
  using Self = ClockLatch;
  LIMB_RING_FIELDS(fields, LIMB_RING_CLOCK_LATCH)

  template <class Archive>
  void archive(Archive& a) {
    fields([&](auto member, const Field& field) { a(field.name, this->*member); });
  }
};

#define LIMB_RING_BEACON(X)                                                                                          \
  X(std::uint64_t, boot, 0, "boot number", "of this node (4.8)", kNews)                                              \
  X(std::uint32_t, cpu_boots, 0, "CPU boots", "how often the CPU of this node has started", kNews,                   \
    "as `cpu.boots`, there")                                                                                         \
  X(CpuState, cpu_state, CpuState::none, "CPU state",                                                                \
    "0 none, 1 absent, 2 booting, 3 running, 4 silent, 5 failed (8.13)", kNews, "as `cpu.state`, there")             \
  X(std::uint32_t, cpu_silent_ms, 0, "CPU silent", "ms since the CPU last spoke; 0xFFFFFFFF if more", kNoNews,       \
    "as `cpu.silent_ms`, there")                                                                                     \
  X(LinkState, input, LinkState::down, "input state",                                                                \
    "0 down (never up), 1 up, 2 silent (was up, is lost), 3 folded (the second line stands for it)", kNews,          \
    "its line in: down, up, folded")                                                                                 \
  X(NodeId, input_from, NodeId{0}, "input from", "id of the upstream neighbour; means nothing if the input is down", \
    kNews)                                                                                                           \
  X(LinkState, output, LinkState::down, "output state", "as input state", kNews, "its line out: down, up, folded")   \
  X(NodeId, output_to, NodeId{0}, "output to", "id of the downstream neighbour", kNews)                              \
  X(bool, break_known, false, "break known", "0 or 1: this node knows of a broken line (8.3)", kNews)                \
  X(NodeId, break_before, NodeId{0}, "break before", "id of the node before it; 0 if no break is known")             \
  X(NodeId, break_behind, NodeId{0}, "break behind", "id of the node behind it; 0 if no break is known")             \
  X(bool, cpu_comes_back, true, "CPU comes back", "0 or 1: somebody starts the CPU again when a reset kills it",     \
    kNoNews, "somebody starts its CPU again when a reset kills it")
/// Behind these, if one of them says something.
#define LIMB_RING_BEACON_LATCHED(X)                                                                                  \
  X(bool, stop_latched, false, "stop latched", "0 or 1: the CPU says that it has stopped, and has not been resumed", \
    kNoNews, "as `cpu.stop.latched`, there")                                                                         \
  X(ClockLatch, latch, {}, "", "", kNoNews, "the last latch of its clock")
/// Sent every 100 ms by default, and at once on most changes (protocol.md section 8.2).
struct Beacon {
  using Self = Beacon;
  LIMB_RING_FIELDS(always, LIMB_RING_BEACON)
  LIMB_RING_FIELDS(latched, LIMB_RING_BEACON_LATCHED)

  template <class Visit>
  static constexpr void fields(const Visit& visit) {
    always(visit);
    latched(visit);
  }
  template <class Archive>
  void archive(Archive& a) {
    fields([&](auto member, const Field& field) { a(field.name, this->*member); });
  }
};

/// After this many missed beacons, or repeated fold words, their sender is gone, or beyond a second break. (ours)
constexpr int kMissedBeacons = 5;

/// What nodes of a ring that folds back tell each other, in slices of their own between packets.
enum class FoldWordKind : std::uint8_t {
  begin = 1,  ///< what follows is the ring's traffic, turned back at `node`, which is before a break
  last,       ///< the end of that traffic: `node` sends on the first line again
  lost,       ///< no more of that traffic comes: the second line is broken at `node`
  deaf,       ///< to the neighbour only: `node` hears nothing on the first line
  hears       ///< to the neighbour only: `node` hears the first line again
};

#define LIMB_RING_FOLD_WORD(X)                                    \
  X(FoldWordKind, kind, FoldWordKind::begin, "kind", "see below") \
  X(NodeId, node, NodeId{0}, "node", "id")
/// A word that noise has changed could make a node fold, or unfold, for nothing. So one with a wrong check is
/// discarded; the sender repeats it a beacon period later.
#define LIMB_RING_FOLD_CHECK(X) X(std::uint8_t, check, 0, "check", "0xFF xor kind xor node")
struct FoldWord {
  using Self = FoldWord;
  LIMB_RING_FIELDS(fields, LIMB_RING_FOLD_WORD)
};
constexpr std::uint8_t fold_check(std::uint8_t kind, NodeId node) { return static_cast<std::uint8_t>(~(kind ^ node)); }

/// Bytes of a field on the line.
template <class T>
constexpr std::size_t kFieldSize = sizeof(T);
#define LIMB_RING_FIELD_SIZE(type, ...) +kFieldSize<type>
template <>
inline constexpr std::size_t kFieldSize<ClockLatch> = 0 LIMB_RING_CLOCK_LATCH(LIMB_RING_FIELD_SIZE);

/// A hello and a beacon have one byte more, which says which of them it is.
constexpr std::size_t kHelloSize = 1 LIMB_RING_HELLO(LIMB_RING_FIELD_SIZE);
constexpr std::size_t kBeaconSize = 1 LIMB_RING_BEACON(LIMB_RING_FIELD_SIZE);
constexpr std::size_t kLongBeaconSize = kBeaconSize LIMB_RING_BEACON_LATCHED(LIMB_RING_FIELD_SIZE);
static_assert(kFoldWordSize == 0 LIMB_RING_FOLD_WORD(LIMB_RING_FIELD_SIZE) LIMB_RING_FOLD_CHECK(LIMB_RING_FIELD_SIZE));

/// @param out room for kHelloSize bytes for a hello, kLongBeaconSize for a beacon. @return bytes written
std::size_t encode(const Hello& hello, std::uint8_t* out);
std::size_t encode(const Beacon& beacon, std::uint8_t* out);
void put(SliceWriter& line, FoldWord word);

/// @return nothing if the bytes are no such message
std::optional<Hello> decode_hello(ByteView data);
std::optional<Beacon> decode_beacon(ByteView data);
/// @return nothing if the slice is not a fold word, is damaged, or has an unknown kind
std::optional<FoldWord> fold_word(const Slice& slice);

/// Whether a beacon says something that other nodes tell their CPUs at once.
bool is_news(const Beacon& before, const Beacon& now);
bool operator==(const ClockLatch& one, const ClockLatch& other);

}  // namespace limb_ring::wire
