#pragma once

#include <array>
#include <cstdint>

#include "io/link_header.h"
#include "wire/bytes.h"

namespace limb_ring::link {

// Keyed UDP lines: who may say something, and that nothing is said twice (ours, protocol.md section 6.14). Nothing here
// knows a socket or a clock. The construction is libsodium's: BLAKE2b with a key for the handshake and for deriving
// keys, ChaCha20-Poly1305 (RFC 8439) with the datagram as additional data after it, whose nonce is the datagram's
// number. Datagrams are authenticated and numbered, not encrypted: so they cost half as much, and can still be read in
// a capture.

constexpr std::size_t kTagSize = 16;
/// Behind a datagram of a session: its number, 64 bits, and its tag.
constexpr std::size_t kSealSize = 8 + kTagSize;

using Key = std::array<std::uint8_t, 32>;
using Nonce = std::array<std::uint8_t, 16>;
using Tag = std::array<std::uint8_t, kTagSize>;

/// Random bytes of the kernel's.
Nonce fresh_long_nonce();

/// Bytes of a `connect_keyed`: those of a `connect`, the asker's nonce, a tag.
constexpr std::size_t kKeyedConnectSize = kConnectSize + sizeof(Nonce) + kTagSize;

/// Lets each number through once, in whatever order they come, as long as it is not far behind the highest one.
class ReplayWindow {
 public:
  /// Numbers that are so far behind the highest one are not known any more, and count as seen.
  static constexpr std::uint64_t kSize = 2048 - 64;

  /// @return false: it was there before, or is too old to tell
  bool take(std::uint64_t number);

 private:
  static constexpr std::uint64_t kWords = 32;
  std::array<std::uint64_t, kWords> seen_{};
  std::uint64_t highest_ = 0;
};

/// Numbers and tags the datagrams that one end of a session sends.
class Sealer {
 public:
  explicit Sealer(const Key& key) : key_(key) {}

  /// Appends number and tag. A number is never used twice, also if the datagram is not sent: 64 bits outlast any
  /// session.
  /// @param datagram has room for kSealSize bytes behind `size`
  void seal(std::uint8_t* datagram, std::size_t size);

 private:
  Key key_;
  std::uint64_t number_ = 0;
};

/// Judges the datagrams that come from the other end of a session.
class Opener {
 public:
  enum class Verdict : std::uint8_t {
    good,       ///< sealed with the key of this session and direction, and not seen before
    truncated,  ///< too short to be sealed
    forged,     ///< no tag that this key makes for these bytes
    replayed    ///< seen before, or too far behind to tell
  };

  explicit Opener(const Key& key) : key_(key) {}

  /// @param datagram all of it, number and tag included
  Verdict open(wire::ByteView datagram);

 private:
  Key key_;
  ReplayWindow window_;
};

/// The keys of a session, one for each direction.
struct SessionKeys {
  Key forward;   ///< from the sending end to the receiving end: slices
  Key backward;  ///< signs of life and refusals
};

/// What the two ends have told each other before a session begins; its keys are made from it.
struct Handshake {
  Nonce asker{};     ///< the sending end's
  Nonce answerer{};  ///< the receiving end's
  std::uint64_t session = 0;
  std::uint8_t from = 0, to = 0;  ///< node ids
};

/// A ring's key, on one of its lines: makes and checks the tags of a handshake, and the keys of its sessions. A tag or
/// a session key of one line, ring or pair of nodes is worth nothing for another.
class LineKey {
 public:
  /// @param ring ring_hash() of its name
  LineKey(const Key& ring_key, std::uint64_t ring, bool second_line);

  /// The tag of a handshake message to node `to`. An answer's tag covers the asker's nonce: it fits no other question.
  Tag tag(wire::ByteView message, const Nonce& asker, std::uint8_t to) const;
  bool check(wire::ByteView message, const Nonce& asker, std::uint8_t to, const std::uint8_t* tag) const;

  SessionKeys session(const Handshake& handshake) const;

 private:
  Key handshake_;
  Key sessions_;
};

}  // namespace limb_ring::link
