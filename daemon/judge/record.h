#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "core/archive.h"
#include "core/journal.h"
#include "core/settings.h"
#include "wire/bytes.h"
#include "wire/packet.h"
#include "wire/slice.h"

/// The records of a flight recorder: what a driver does to a core. (ours)

namespace limb_ring::recorder {

/// Slices that the driver took for that line.
struct Written {
  core::Line line;
  wire::ByteView slices;  ///< as put_slices() writes them

  template <class Archive>
  void archive(Archive& a) {
    a("line", line)("slices", slices);
  }
};

/// A packet that its CPU has taken. Its data came in with a slice, and is not recorded again.
struct Taken {
  core::Time at{};
  wire::NodeId source{}, destination{};
  wire::Priority priority{};
  wire::ChannelId channel{};
  std::uint16_t size = 0;
  std::uint32_t crc = 0;  ///< of its data

  Taken() = default;
  explicit Taken(const core::ReceivedPacket& packet)
      : at(packet.at),
        source(packet.source),
        destination(packet.destination),
        priority(packet.priority),
        channel(packet.channel),
        size(packet.size),
        crc(wire::crc32(packet.bytes())) {}

  template <class Archive>
  void archive(Archive& a) {
    a("at", at)("source", source)("destination", destination)("priority", priority)("channel", channel);
    a("size", size)("crc", crc);
  }
};

/// One call of a core: what went in, or what was taken out.
struct Record {
  core::Time at{};  ///< of the call, or of the one before if that one is not told the time
  std::variant<core::Input, Written, core::Event, Taken> what;
  bool data_left_out = false;  ///< it is a packet that came in, of which the data is not there: zeroes
};

/// Bytes of any value that has an archive(), for comparison.
template <class T>
std::vector<std::uint8_t> bytes_of(const T& what) {
  for (std::size_t room = 1024;; room *= 2) {
    std::vector<std::uint8_t> bytes(room);
    core::StateWriter writer(bytes.data(), bytes.size());
    const_cast<T&>(what).archive(writer);  // a writer changes nothing
    if (writer.failed()) continue;
    bytes.resize(writer.size());
    return bytes;
  }
}

}  // namespace limb_ring::recorder

/// What RecordWriter writes and RecordReader reads (ours), in the byte order of the machine, as a recording is replayed
/// by the same program. A record:
///
///     | tag 8 | time since the record before 64; 128 or none if the tag says so | what it is of |
///
/// A slice that came in, and one of which the data is left out:
///
///     | line 8 | kind 8 | size 32 | bytes |        | line 8 | kind 8 + kAbridged | size 32 | header, trailer, CRC 96 |
///
/// The slices that were written to a line, each as put_slices() writes it:
///
///     | line 8 | bytes in all 32 | slices |

namespace limb_ring::recorder {

/// @name Tags of records. An input's tag is its index in core::Input
///@{
constexpr std::uint8_t kInputTags = std::variant_size_v<core::Input>;
constexpr std::uint8_t kWrittenTag = kInputTags, kEventTag = kInputTags + 1, kPacketTag = kInputTags + 2;
/// Added to a tag: at the same time as the record before; or so much later that it takes 128 bits.
constexpr std::uint8_t kSameTime = 0x80, kMuchLater = 0x40;
static_assert(kPacketTag < kMuchLater);
///@}

}  // namespace limb_ring::recorder

/// How a recording lies in memory and in its file (ours):
///
///     | Title, kTitleSize bytes | half | half |       half: | HalfHead | state | record | record ...
///
/// The halves are used in turn, so that at least one of them is there whenever the process is killed. Each begins
/// with the state of the core (core/archive.h), from which its records go on.

namespace limb_ring::recorder {

constexpr std::array<char, 8> kMagic{'l', 'i', 'm', 'b', 'r', 'e', 'c', '7'};
constexpr std::size_t kTitleSize = 16384;

/// What does not change while a node lives.
struct Title {
  std::uint64_t layout = 0;  ///< core::StateLayout of the program's core
  std::string program;       ///< its version
  std::string ring, node;    ///< names
  std::uint64_t half = 0;    ///< bytes of a half
  std::int64_t zero = 0;     ///< ns, the machine's steady clock at time 0 of the core
  std::int64_t date = 0;     ///< ns since 1970-01-01 then
  core::Settings settings;

  template <class Archive>
  void archive(Archive& a) {
    a("layout", layout)("program", program)("ring", ring)("node", node)("half", half)("zero", zero)("date", date);
    a("settings", settings);
  }
};

struct HalfHead {
  std::atomic<std::uint64_t> generation;  ///< 1, 2, 3 ...; 0 while the state is being written
  std::atomic<std::uint64_t> used;        ///< bytes behind this head that are complete
};
static_assert(sizeof(HalfHead) == 16 && std::atomic<std::uint64_t>::is_always_lock_free);

/// The layout of the state of a core of this program, as in Title::layout.
std::uint64_t state_layout();

/// Puts bytes one behind the other. What each packet causes is written by it and not by an archive, which asks for room
/// for each number. (ours)
class Packed {
 public:
  /// @param to room for all of it
  explicit Packed(std::uint8_t* to) : to_(to) {}
  template <class T>
  Packed& operator<<(T value) {
    std::memcpy(to_, &value, sizeof value);
    to_ += sizeof value;
    return *this;
  }
  Packed& operator<<(wire::ByteView all) {
    if (!all.empty()) std::memcpy(to_, all.data, all.size);
    to_ += all.size;
    return *this;
  }

 private:
  std::uint8_t* to_;
};

/// Reads what a RecordWriter has written, or anybody else. (ours)
class RecordReader {
 public:
  /// @param records must outlive this, and what is read
  /// @param last time of the record before the first
  RecordReader(wire::ByteView records, core::Time last) : rest_(records), last_(last) {}

  /// True if all was read.
  bool complete() const { return rest_.complete(); }
  /// @return nothing if the bytes are not a record, or one that no driver of a core would leave. The bytes of a packet
  ///         whose data was left out are there until the next record is read
  std::optional<Record> next();

 private:
  /// The time since the record before.
  core::Duration read_step(std::uint8_t tag);
  std::optional<Record> read(std::uint8_t tag);
  /// @return false if it is none
  bool read(core::input::Receive& call, bool& data_left_out);
  bool read_abridged(wire::Slice& slice, std::uint32_t size);

  core::StateReader rest_;
  core::Time last_;
  std::array<std::uint8_t, wire::kMaxDataPacketSize> packet_{};  ///< whose data was left out
};

/// Writes records one behind the other. (ours)
class RecordWriter {
 public:
  /// @param room where they are written; must outlive this
  /// @param last time of the record before the first
  RecordWriter(core::StateWriter room, core::Time last) : room_(room), last_(last) {}

  /// @name Write one record. Of packets that only pass the node, the data is left out.
  /// @param at not before last()
  ///@{
  void put(core::Time at, const core::Input& input);
  void put(core::Time at, const Written& written);
  /// As a Written has them.
  void put_written(core::Time at, core::Line line, wire::ByteView framed_slices);
  void put(core::Time at, const core::Event& event);
  void put(core::Time at, const Taken& packet);
  ///@}

  /// A record had no room: it is not whole, and nothing was written since.
  bool failed() const { return room_.failed(); }
  /// Bytes in the room, also of what was there before the first record.
  std::size_t size() const { return room_.size(); }
  std::size_t left() const { return room_.left(); }
  /// Where the next record goes.
  const std::uint8_t* next() const { return room_.next(); }
  /// Data was left out of one of the records.
  bool left_out() const { return left_out_; }
  /// Time of the last record.
  core::Time last() const { return last_; }

 private:
  /// Begins a record. @return where its next `size` bytes go; null if there is no room
  std::uint8_t* begin(std::uint8_t tag, core::Time at, std::size_t size = 0);
  void put_receive(std::uint8_t tag, core::Time at, const core::input::Receive& call);

  core::StateWriter room_;
  core::Time last_;
  bool left_out_ = false;
};

/// What a packet is known by wherever it is: its CRC and the fields that no relay changes.
std::uint64_t key_of(const wire::PacketFields& packet);

/// The data of packets, for the recordings of nodes that they only pass: these have all but the data. (ours)
class PacketData {
 public:
  /// Packets of which it keeps the data, the newest.
  static constexpr std::size_t kMost = 4096;

  /// @param packet a whole DATP whose CRC is right
  void keep(wire::ByteView packet);
  /// Fills in the data of a packet of which all else is there: as it was kept, or else made up, so that the CRC is
  /// right. To a node that it only passes that makes no difference.
  /// @param size bytes of the packet, at least kLeastAbridged
  /// @return false: made up
  bool fill_in(std::uint8_t* packet, std::size_t size);
  /// Its data is here: kept, or made up.
  bool knows(wire::ByteView packet) const { return packets_.count(key_of({packet})) != 0; }
  /// The data of that packet was made up.
  bool is_made_up(wire::ByteView packet) const;

 private:
  struct Kept {
    std::vector<std::uint8_t> data;
    bool made_up = false;
  };
  void put(std::uint64_t key, wire::ByteView data, bool made_up);

  std::unordered_map<std::uint64_t, Kept> packets_;
  std::deque<std::uint64_t> order_;  ///< of their arrival
};

}  // namespace limb_ring::recorder

/// How packets are recorded whose data the core does not look at: header, trailer and CRC stand for the whole. (ours)

namespace limb_ring::recorder {

/// Added to the kind of a slice: its data is left out.
constexpr std::uint8_t kAbridged = 0x80;
/// Bytes of a packet that are left: its header, and its trailer with the CRC.
constexpr std::size_t kTail = wire::kTrailerSize + wire::kCrcSize;
constexpr std::size_t kAbridgedSize = wire::kHeaderSize + kTail;
/// Least size of a packet that is abridged, bytes: with less data it would not become much shorter.
constexpr std::size_t kLeastAbridged = kAbridgedSize + 16;

/// A whole DATP with data enough.
inline bool can_be_abridged(const wire::Slice& slice) {
  return slice.kind == wire::SliceKind::whole && slice.bytes.size >= kLeastAbridged;
}

/// Writes what is left of a packet: kAbridgedSize bytes.
void put_abridged(Packed to, wire::ByteView packet);

/// Writes framed slices, abridged if that can be:
///
///     | kind 8 | size 16 | bytes |        or        | kind 8 + kAbridged | size 16 | header 32 | trailer 32 | CRC 32 |
void put_slices(core::StateWriter& room, wire::ByteView framed_slices);

}  // namespace limb_ring::recorder
