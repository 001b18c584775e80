#pragma once

#include <cstdint>
#include <vector>

#include "core/time.h"
#include "wire/slice.h"

/// The specification once more: a node as docs/protocol.md says it, small and slow, written without the core. It uses
/// the core's door alone (network_controller.h and what its calls take and give), so that both can be compared.
namespace limb_ring::model {

using core::Duration;
using core::kNever;
using core::Time;
using Bytes = std::vector<std::uint8_t>;
using wire::SliceKind;

/// A slice that has been given out. (protocol.md section 6.2)
struct Given {
  SliceKind kind;
  Bytes bytes;
};

constexpr int kAll = 0xFF;  ///< as DID: broadcast
constexpr std::uint8_t kSop = 0xFB, kEop = 0xFD;

/// protocol.md section 3.7.
std::uint32_t crc_of(const Bytes& bytes, std::size_t count);

/// A packet as its bytes; protocol.md sections 3.1 to 3.6.
struct Packet {
  Bytes bytes;

  bool interrupt() const { return (bytes[0] >> 5 & 1) != 0; }
  int code() const { return bytes[0]; }
  int incarnation() const { return bytes[0] >> 6; }
  int attempt() const { return bytes[0] >> 3 & 3; }
  int sequence() const { return bytes[0] & 7; }
  int hop() const { return bytes[2]; }
  int source() const { return bytes[3]; }
  int eop() const { return bytes[bytes.size() - 8]; }
  int fbc() const { return bytes[bytes.size() - 7]; }
  int destination() const { return bytes[bytes.size() - 6]; }
  int last() const { return bytes[bytes.size() - 5]; }  ///< PRI or INT
  int channel() const { return last() >> 2; }
  int priority() const { return last() & 3; }
  int factor() const { return last() & 7; }
  bool control() const { return !interrupt() && channel() == 1; }
  bool broadcast() const { return destination() == kAll; }
  Bytes data() const { return Bytes(bytes.begin() + 4, bytes.end() - 8); }
  std::uint32_t crc() const;
  bool crc_right() const { return crc() == crc_of(bytes, bytes.size() - 4); }
  /// HOP and FBC as given, and the CRC as wrong as before: what is added to a CRC by a change does not depend on the
  /// rest, so it is found from both whole sums.
  void rewrite(int hop, int fbc);
};

/// As its source sends it: HOP 0, FBC 0xFF.
Packet make_packet(int code, int source, int destination, int last, const Bytes& data);

/// Code: protocol.md section 3.3.
inline int code_byte(std::uint64_t boot, bool interrupt, int attempt, int sequence) {
  return static_cast<int>((boot & 3) << 6) | (interrupt ? 0x20 : 0) | attempt << 3 | sequence;
}

}  // namespace limb_ring::model
