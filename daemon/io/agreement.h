#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

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

/// Bit i is set where part i differs; 0: the two agree.
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

}  // namespace limb_ring::link
