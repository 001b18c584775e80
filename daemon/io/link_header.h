#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "wire/bytes.h"

namespace limb_ring::link {

/// What both ends of a link must agree on beside the version of the protocol: a hash for each part of the ring's file
/// (ours, protocol.md section 6.13). It travels behind the header of a `connect`, so that a node that runs another file
/// is refused by name, and is not found out by odd behaviour. What may differ from host to host is in none of them.
struct Agreement {
  static constexpr std::size_t kParts = 7;
  /// In this order: nodes, redundancy, timeouts, lines, joints, pins, supervisor.
  std::array<std::uint64_t, kParts> parts{};
};

/// Bytes of an Agreement on a link.
constexpr std::size_t kAgreementSize = 8 * Agreement::kParts;

/// @param out kAgreementSize bytes
void store_agreement(std::uint8_t* out, const Agreement& agreement);
/// @param bytes kAgreementSize of them
Agreement load_agreement(const std::uint8_t* bytes);

/// Bit i is set if part i differs; 0: the two agree.
std::uint32_t differences(const Agreement& ours, const Agreement& theirs);
/// For people, such as "nodes and timeouts differ". @param differing as differences() says
std::string differing_parts(std::uint32_t differing);

/// FNV-1a, 64 bits: finds what differs by mistake, is no secret.
std::uint64_t text_hash(const std::string& text);

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;

/// Where a node listens for its upstream neighbour. (ours)
struct Endpoint {
  enum class Transport { unix_stream, shm, udp } transport = Transport::unix_stream;
  std::string path;        ///< unix_stream, shm: the socket, at most 107 bytes
  std::string address;     ///< udp: a numeric address; bound there and nowhere else
  std::uint16_t port = 0;  ///< udp

  static Endpoint unix_stream(std::string path) { return {Transport::unix_stream, std::move(path), {}, 0}; }
  static Endpoint shm(std::string path) { return {Transport::shm, std::move(path), {}, 0}; }
  static Endpoint udp(std::string address, std::uint16_t port) {
    return {Transport::udp, {}, std::move(address), port};
  }
};

/// For messages: a path, or ADDRESS:PORT.
std::string to_string(const Endpoint& endpoint);

/// The times both ends of a link live by. (ours, protocol.md section 7.4)
struct Timing {
  milliseconds idle{50};              ///< a quiet end says so this often; also the grain of all else here
  milliseconds silence{250};          ///< an end silent for so long counts as gone
  milliseconds first_successor{200};  ///< at start: only the configured successor is asked for so long
  milliseconds attempt{1000};         ///< an attempt to connect that is not answered by then is given up
  milliseconds retry{20};             ///< a node that was not there, or busy, is asked again; see candidate_retry()

  /// Larger rings wait longer in proportion, so that asking dead nodes stays cheap.
  milliseconds candidate_retry(std::size_t nodes) const { return retry * (1 + (nodes - 1) / 16); }
  /// A pending connection, or the offer of a session over UDP, that is not taken up by then is dropped.
  milliseconds handshake() const { return 4 * silence; }
};

class LineKey;

/// Who we are on which ring.
struct Identity {
  std::uint64_t ring = 0;                        ///< ring_hash() of its name
  std::uint8_t id = 0;                           ///< 0 to 254
  Agreement agreement = {};                      ///< what we expect of the file that the other end runs
  std::shared_ptr<const LineKey> key = nullptr;  ///< of our UDP lines; none: they are not keyed
};

/// FNV-1a, 64 bits, of a ring's name: keeps two rings apart, is no secret.
std::uint64_t ring_hash(const std::string& name);

/// What the two ends of a link say about the link itself (ours, protocol.md section 6.5). A UDP datagram is a header
/// and, if its type is `slices`, one slice. A UNIX stream opens with one `connect` header, goes on with bare slices,
/// and carries headers the other way. A line through shared memory opens with `connect_memory`, which brings two
/// descriptors along; its slices go through the memory.
///
///   | magic "LR" | version 8 | type 8 | ring hash 64 | session 64 | sequence 32 | sender 8 | refusal 8 |
///
/// Session: the upper half is a random number of the connecting end, the lower half one of the
/// accepting end. So neither an old connect nor an old datagram can revive an old session.
///
/// Behind the header of a `connect`, of whatever kind, comes what both ends must agree on.
enum class LinkHeaderType : std::uint8_t {
  connect = 1,
  accept,
  refuse,
  slices,
  alive,
  bye,
  connect_memory,
  connect_keyed
};

/// Why a node does not want, or no longer wants, the one that it says `refuse` to.
enum class Refusal : std::uint8_t {
  none = 0,
  busy,             ///< has an upstream nearer to it than the one that asks
  replaced,         ///< had the asker as its upstream, has a nearer or newer one now
  wrong_ring,       ///< belongs to a ring of another name
  not_in_ring,      ///< does not know this node id
  unknown_session,  ///< has restarted or given up this session: connect again
  closing,          ///< is shutting down
  wrong_version,    ///< speaks another version of the protocol
  invalid_memory,   ///< cannot use the shared memory that was offered
  other_ring_file,  ///< runs another ring file; `sequence` says which parts differ
  needs_key,        ///< its lines are keyed, and the one that asks has no key
  no_key,           ///< the one that asks has a key, it has none
  wrong_key         ///< has another key
};
const char* to_string(Refusal refusal);

constexpr std::size_t kLinkHeaderSize = 26;
constexpr std::uint16_t kLinkMagic = 0x4C52;
constexpr std::uint8_t kLinkVersion = 3;

struct LinkHeader {
  std::uint8_t version = kLinkVersion;
  LinkHeaderType type = LinkHeaderType::alive;
  std::uint64_t ring = 0;
  std::uint64_t session = 0;
  std::uint32_t sequence = 0;  ///< type slices: 1, 2, ... within the session; refusal other_ring_file: differences()
  std::uint8_t sender = 0;     ///< node id
  Refusal refusal = Refusal::none;
};

/// @param out kLinkHeaderSize bytes
void store_header(std::uint8_t* out, const LinkHeader& header);
std::array<std::uint8_t, kLinkHeaderSize> encode(const LinkHeader& header);

/// True if the reason is the key: one end has none, or another one.
bool of_keys(Refusal refusal);
/// It asks to connect, in one of the three ways.
bool asks_to_connect(LinkHeaderType type);

/// The bytes of a `connect` header and what both ends must agree on.
constexpr std::size_t kConnectSize = kLinkHeaderSize + kAgreementSize;
std::array<std::uint8_t, kConnectSize> encode_connect(const LinkHeader& connect, const Agreement& ours);

/// @return nothing if `bytes` do not begin with a header. Of another version only a `connect`, and a `refuse` for that
/// reason, are headers: their format is the same in all versions, so that each end can say what is wrong.
std::optional<LinkHeader> parse_header(wire::ByteView bytes);

/// Why the sender of `refuse` does not want us, in words for people.
std::string reason_of(const LinkHeader& refuse);
/// For people: the other end speaks version `peer`, which we do not; and which end to update.
std::string version_mismatch(std::uint8_t peer);
/// What is at the other end sends no headers.
constexpr const char* kNoNode = "peer is not a limb_ring node";

inline std::uint32_t session_nonce(std::uint64_t session) { return static_cast<std::uint32_t>(session >> 32); }

/// A number nobody has used lately, not 0.
std::uint32_t fresh_nonce();

}  // namespace limb_ring::link
