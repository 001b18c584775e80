#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "limb_ring/payload/announcement.h"
#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/fragment.h"

namespace limb_ring::payload {

/// Reassembles the fragments of many sources and topics. No IO, no clock. (ours)
///
/// It relies on the ring's order per source: a piece that comes too early means that the one before it is lost, and its
/// message is dropped and counted. A repeated piece is ignored. At most one message per (source, topic) is under way:
/// the first piece of the next message ends it. Data counts only after an announcement. An announcement starts its
/// topic anew, so a sender that restarts announces again and may number from 0.
class Reassembler {
 public:
  struct Limits {
    std::size_t message = std::size_t{16} << 20;  ///< bytes of one message
    /// Bytes of all messages under way and announcements kept. Beside them at most 65,280
    /// (source, topic) pairs of about 200 bytes each.
    std::size_t total = std::size_t{64} << 20;
  };

  /// Messages dropped, by reason, and fragments left out. Sums since the start.
  struct Counters {
    std::uint64_t messages = 0;       ///< put together, announcements not included
    std::uint64_t announcements = 0;  ///< put together and understood
    std::uint64_t lost = 0;           ///< a piece is missing, or the next message began too early
    std::uint64_t unannounced = 0;    ///< data of a topic nobody announced
    std::uint64_t too_large = 0;      ///< longer than Limits::message
    std::uint64_t no_memory = 0;      ///< Limits::total has no room left beside the announcements
    std::uint64_t evicted = 0;        ///< longest idle, given up for a newer one
    std::uint64_t corrupt = 0;        ///< wrong checksum, or a malformed announcement
    std::uint64_t malformed = 0;      ///< packets that are not a fragment
    std::uint64_t duplicates = 0;     ///< fragments that came again, or of an older message
    std::uint64_t ignored = 0;        ///< further fragments of a message dropped already
  };

  struct Message {
    std::uint8_t source = 0;
    std::uint8_t topic = 0;
    Fragment::Kind kind = Fragment::Kind::data;
    std::vector<std::uint8_t> bytes;  ///< of data; empty for an announcement, see announcement()
  };

  Reassembler() : Reassembler(Limits{}) {}
  explicit Reassembler(const Limits& limits) : limits_(limits) {}

  /// Takes one packet of channel 3. @return the message it completes
  std::optional<Message> take(std::uint8_t source, ByteView packet);
  /// What (source, topic) announced last; null if nothing. Valid until the next take().
  const Announcement* announcement(std::uint8_t source, std::uint8_t topic) const;
  const Counters& counters() const { return counters_; }
  /// Bytes that count against Limits::total now.
  std::size_t held() const { return held_; }

 private:
  /// Which message a fragment belongs to.
  struct Identity {
    Fragment::Kind kind;
    std::uint32_t message, total, checksum;
    bool operator==(const Identity& other) const;
  };
  struct Stream {
    std::optional<Identity> current;  // under way, complete or dropped
    bool collecting = false;
    std::uint16_t next = 0;  // index of the fragment to come
    std::vector<std::uint8_t> bytes;
    std::uint64_t touched = 0;  // packet count when the last piece came
    std::optional<Announcement> announcement;
    std::size_t announcement_size = 0;
  };
  using Key = std::pair<std::uint8_t, std::uint8_t>;

  static Identity identity(const Fragment& fragment);
  static bool is_stale(const Stream& stream, const Fragment& fragment);
  static bool starts_afresh(const Stream& stream, const Fragment& fragment);
  void begin(Stream& stream, const Fragment& fragment);
  bool admit(const Stream& stream, const Fragment& fragment);
  bool make_room(std::size_t size);
  Stream* longest_idle();
  bool append(Stream& stream, const Fragment& fragment);
  void drop(Stream& stream, std::uint64_t& counter);
  std::optional<Message> finish(const Key& key, Stream& stream);
  bool keep_announcement(Stream& stream, ByteView bytes);

  Limits limits_;
  Counters counters_;
  std::map<Key, Stream> streams_;
  std::size_t held_ = 0;
  std::uint64_t packets_ = 0;
};

}  // namespace limb_ring::payload
