#pragma once

#include <vector>

#include "io/link_header.h"

namespace limb_ring::link {

/// A header as node `sender` of that ring would send it.
inline LinkHeader header_of(std::uint64_t ring, LinkHeaderType type, std::uint64_t session, std::uint8_t sender) {
  LinkHeader header;
  header.type = type;
  header.ring = ring;
  header.session = session;
  header.sender = sender;
  return header;
}

/// A datagram; a `connect` has nothing to disagree about.
inline std::vector<std::uint8_t> datagram_of(const LinkHeader& header, wire::ByteView slices) {
  std::vector<std::uint8_t> bytes(kLinkHeaderSize);
  store_header(bytes.data(), header);
  if (header.type == LinkHeaderType::connect) bytes.resize(kConnectSize);
  bytes.insert(bytes.end(), slices.begin(), slices.end());
  return bytes;
}

}  // namespace limb_ring::link
