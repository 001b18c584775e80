#include "limb_ring/payload/fragmenter.h"

#include <algorithm>

namespace limb_ring::payload {

bool Fragmenter::start(Fragment::Kind kind, std::vector<std::uint8_t> message) {
  if (message.size() > kMaxMessage) return false;
  kind_ = kind;
  message_ = std::move(message);
  checksum_ = fnv1a({message_.data(), message_.size()});
  count_ = fragment_count(message_.size());
  index_ = 0;
  ++number_;
  return true;
}

std::vector<std::uint8_t> Fragmenter::next() {
  Fragment fragment;
  fragment.kind = kind_;
  fragment.topic = topic_;
  fragment.message = number_;
  fragment.index = index_;
  fragment.count = count_;
  fragment.total = static_cast<std::uint32_t>(message_.size());
  fragment.checksum = checksum_;
  const std::size_t offset = std::size_t{index_} * kFragmentBytes;
  fragment.bytes = {message_.data() + offset, std::min(kFragmentBytes, message_.size() - offset)};
  ++index_;
  return encode(fragment);
}

}  // namespace limb_ring::payload
