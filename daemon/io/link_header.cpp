#include "io/link_header.h"

#include <random>
#include <vector>

#include "wire/bytes.h"

namespace limb_ring::link {
namespace {

constexpr std::array<const char*, Agreement::kParts> kPartNames{"nodes",  "redundancy", "timeouts",  "lines",
                                                                "joints", "pins",       "supervisor"};

}  // namespace

void store_agreement(std::uint8_t* out, const Agreement& agreement) {
  for (std::size_t i = 0; i < Agreement::kParts; ++i) wire::store_u64(out + 8 * i, agreement.parts[i]);
}

Agreement load_agreement(const std::uint8_t* bytes) {
  Agreement agreement;
  for (std::size_t i = 0; i < Agreement::kParts; ++i) agreement.parts[i] = wire::load_u64(bytes + 8 * i);
  return agreement;
}

std::uint32_t differences(const Agreement& ours, const Agreement& theirs) {
  std::uint32_t differing = 0;
  for (std::size_t i = 0; i < Agreement::kParts; ++i)
    if (ours.parts[i] != theirs.parts[i]) differing |= 1u << i;
  return differing;
}

std::string differing_parts(std::uint32_t differing) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < Agreement::kParts; ++i)
    if ((differing >> i & 1) != 0) names.emplace_back(kPartNames[i]);
  if (names.empty()) return "something differs";
  std::string text = names[0];
  for (std::size_t i = 1; i < names.size(); ++i) text += (i + 1 == names.size() ? " and " : ", ") + names[i];
  return text + (names.size() == 1 && names[0].back() != 's' ? " differs" : " differ");
}

std::uint64_t text_hash(const std::string& text) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001B3u;
  return hash;
}

std::string to_string(const Endpoint& endpoint) {
  if (endpoint.transport != Endpoint::Transport::udp) return endpoint.path;
  return endpoint.address + ":" + std::to_string(endpoint.port);
}

std::uint64_t ring_hash(const std::string& name) { return text_hash(name); }

namespace {

// Byte offsets of the fields.
constexpr std::size_t kVersionAt = 2, kTypeAt = 3, kRingAt = 4, kSessionAt = 12, kSequenceAt = 20, kSenderAt = 24,
                      kRefusalAt = 25;

bool known(std::uint8_t type, std::uint8_t refusal) {
  return type >= static_cast<std::uint8_t>(LinkHeaderType::connect) &&
         type <= static_cast<std::uint8_t>(LinkHeaderType::connect_keyed) &&
         refusal <= static_cast<std::uint8_t>(Refusal::wrong_key);
}

bool of_any_version(const LinkHeader& header) {
  return asks_to_connect(header.type) ||
         (header.type == LinkHeaderType::refuse && header.refusal == Refusal::wrong_version);
}

}  // namespace

const char* to_string(Refusal refusal) {
  switch (refusal) {
    case Refusal::none:
      return "none";
    case Refusal::busy:
      return "it has a nearer upstream neighbour";
    case Refusal::replaced:
      return "a nearer or newer upstream neighbour took our place";
    case Refusal::wrong_ring:
      return "it belongs to another ring";
    case Refusal::not_in_ring:
      return "it does not know our node id";
    case Refusal::unknown_session:
      return "it no longer knows our session";
    case Refusal::closing:
      return "it is shutting down";
    case Refusal::wrong_version:
      return "it speaks another version of the protocol";
    case Refusal::invalid_memory:
      return "it cannot use the shared memory that was offered";
    case Refusal::other_ring_file:
      return "it runs another ring file";
    case Refusal::needs_key:
      return "its lines are keyed, and this node has no key: give links.key in its file";
    case Refusal::no_key:
      return "this node has a key, and it has none: give links.key in its file";
    case Refusal::wrong_key:
      return "it has another key: links.key must be the same file on all hosts";
  }
  return "unknown";
}

void store_header(std::uint8_t* out, const LinkHeader& header) {
  wire::store_u16(out, kLinkMagic);
  out[kVersionAt] = header.version;
  out[kTypeAt] = static_cast<std::uint8_t>(header.type);
  wire::store_u64(out + kRingAt, header.ring);
  wire::store_u64(out + kSessionAt, header.session);
  wire::store_u32(out + kSequenceAt, header.sequence);
  out[kSenderAt] = header.sender;
  out[kRefusalAt] = static_cast<std::uint8_t>(header.refusal);
}

std::string version_mismatch(std::uint8_t peer) {
  return "protocol mismatch: peer speaks version " + std::to_string(peer) + ", this is version " +
         std::to_string(kLinkVersion) + "; update " + (peer < kLinkVersion ? "it" : "this node");
}

std::string reason_of(const LinkHeader& refuse) {
  if (refuse.refusal == Refusal::wrong_version) return version_mismatch(refuse.version);
  if (refuse.refusal == Refusal::other_ring_file)
    return to_string(refuse.refusal) + (": " + differing_parts(refuse.sequence));
  return to_string(refuse.refusal);
}

std::array<std::uint8_t, kLinkHeaderSize> encode(const LinkHeader& header) {
  std::array<std::uint8_t, kLinkHeaderSize> bytes;
  store_header(bytes.data(), header);
  return bytes;
}

bool of_keys(Refusal refusal) {
  return refusal == Refusal::needs_key || refusal == Refusal::no_key || refusal == Refusal::wrong_key;
}

bool asks_to_connect(LinkHeaderType type) {
  return type == LinkHeaderType::connect || type == LinkHeaderType::connect_memory ||
         type == LinkHeaderType::connect_keyed;
}

std::array<std::uint8_t, kConnectSize> encode_connect(const LinkHeader& connect, const Agreement& ours) {
  std::array<std::uint8_t, kConnectSize> bytes;
  store_header(bytes.data(), connect);
  store_agreement(bytes.data() + kLinkHeaderSize, ours);
  return bytes;
}

std::optional<LinkHeader> parse_header(wire::ByteView bytes) {
  if (bytes.size < kLinkHeaderSize || wire::load_u16(bytes.data) != kLinkMagic) return {};
  if (!known(bytes[kTypeAt], bytes[kRefusalAt])) return {};
  LinkHeader header;
  header.version = bytes[kVersionAt];
  header.type = static_cast<LinkHeaderType>(bytes[kTypeAt]);
  header.ring = wire::load_u64(bytes.data + kRingAt);
  header.session = wire::load_u64(bytes.data + kSessionAt);
  header.sequence = wire::load_u32(bytes.data + kSequenceAt);
  header.sender = bytes[kSenderAt];
  header.refusal = static_cast<Refusal>(bytes[kRefusalAt]);
  if (header.version != kLinkVersion && !of_any_version(header)) return {};
  return header;
}

std::uint32_t fresh_nonce() {
  static std::mt19937 numbers{std::random_device{}()};
  const auto number = static_cast<std::uint32_t>(numbers());
  return number == 0 ? 1 : number;
}

}  // namespace limb_ring::link
