#pragma once

#include <array>
#include <cstdint>
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

}  // namespace limb_ring::link
