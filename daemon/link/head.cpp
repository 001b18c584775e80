#include "link/head.h"

#include <random>

namespace limb_ring::link {
namespace {

// Byte offsets of the fields.
constexpr std::size_t kVersionAt = 2, kTypeAt = 3, kRingAt = 4, kSessionAt = 12, kSequenceAt = 20,
                      kSenderAt = 24, kRefusalAt = 25;

bool known(std::uint8_t type, std::uint8_t refusal) {
  return type >= static_cast<std::uint8_t>(HeadType::connect) &&
         type <= static_cast<std::uint8_t>(HeadType::bye) &&
         refusal <= static_cast<std::uint8_t>(Refusal::wrong_version);
}

bool of_any_version(const Head& head) {
  return head.type == HeadType::connect || (head.type == HeadType::refuse && head.refusal == Refusal::wrong_version);
}

}  // namespace

const char* to_string(Refusal refusal) {
  switch (refusal) {
    case Refusal::none: return "none";
    case Refusal::busy: return "it has a nearer upstream neighbour";
    case Refusal::replaced: return "a nearer or newer upstream neighbour took our place";
    case Refusal::wrong_ring: return "it belongs to another ring";
    case Refusal::not_in_ring: return "it does not know our node id";
    case Refusal::unknown_session: return "it no longer knows our session";
    case Refusal::closing: return "it is shutting down";
    case Refusal::wrong_version: return "it speaks another version of the protocol";
  }
  return "unknown";
}

void store_head(std::uint8_t* out, const Head& head) {
  wire::store_u16(out, kHeadMagic);
  out[kVersionAt] = head.version;
  out[kTypeAt] = static_cast<std::uint8_t>(head.type);
  wire::store_u64(out + kRingAt, head.ring);
  wire::store_u64(out + kSessionAt, head.session);
  wire::store_u32(out + kSequenceAt, head.sequence);
  out[kSenderAt] = head.sender;
  out[kRefusalAt] = static_cast<std::uint8_t>(head.refusal);
}

std::string version_mismatch(std::uint8_t peer) {
  return "protocol mismatch: peer speaks version " + std::to_string(peer) + ", this is version " +
         std::to_string(kHeadVersion) + "; update " + (peer < kHeadVersion ? "it" : "this node");
}

std::string reason_of(const Head& refuse) {
  return refuse.refusal == Refusal::wrong_version ? version_mismatch(refuse.version) : to_string(refuse.refusal);
}

std::array<std::uint8_t, kHeadSize> encode(const Head& head) {
  std::array<std::uint8_t, kHeadSize> bytes;
  store_head(bytes.data(), head);
  return bytes;
}

std::optional<Head> parse_head(wire::ByteView bytes) {
  if (bytes.size < kHeadSize || wire::load_u16(bytes.data) != kHeadMagic) return {};
  if (!known(bytes[kTypeAt], bytes[kRefusalAt])) return {};
  Head head;
  head.version = bytes[kVersionAt];
  head.type = static_cast<HeadType>(bytes[kTypeAt]);
  head.ring = wire::load_u64(bytes.data + kRingAt);
  head.session = wire::load_u64(bytes.data + kSessionAt);
  head.sequence = wire::load_u32(bytes.data + kSequenceAt);
  head.sender = bytes[kSenderAt];
  head.refusal = static_cast<Refusal>(bytes[kRefusalAt]);
  if (head.version != kHeadVersion && !of_any_version(head)) return {};
  return head;
}

std::uint32_t fresh_nonce() {
  static std::mt19937 numbers{std::random_device{}()};
  const auto number = static_cast<std::uint32_t>(numbers());
  return number == 0 ? 1 : number;
}

}  // namespace limb_ring::link
