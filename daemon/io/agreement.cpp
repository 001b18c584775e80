#include "io/agreement.h"

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

}  // namespace limb_ring::link
