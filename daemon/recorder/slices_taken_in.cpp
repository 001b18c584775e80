#include "recorder/slices_taken_in.h"

#include <algorithm>
#include <cstring>

namespace limb_ring::recorder {
namespace {

std::uint64_t word_at(const std::uint8_t* bytes, std::size_t place) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes + place, sizeof word);
  return word;
}

/// @pre both are of the same size, and not too short
/// @return false where they differ between their ends
bool compare(const std::uint8_t* from, wire::ByteView to, Differences& found) {
  constexpr std::size_t kEnd = Differences::kEnd;
  if (std::memcmp(from + kEnd, to.data + kEnd, to.size - 2 * kEnd) != 0) return false;
  found.differing = 0;
  for (std::size_t i = 0; i < Differences::kWords; ++i) {
    const std::size_t place = Differences::place(i, to.size);
    found.words[i] = word_at(to.data, place);
    found.differing |= static_cast<std::uint8_t>((word_at(from, place) != found.words[i]) << i);
  }
  return true;
}

}  // namespace

const std::uint8_t* SlicesTakenIn::find(const wire::Slice& given_out, Differences& differences) {
  if (given_out.bytes.size < 2 * Differences::kEnd) return nullptr;
  const std::size_t kept = std::min(added_ - first_, slices_.size());
  for (std::size_t i = added_ - kept; i < added_; ++i) {
    const wire::Slice& taken = slices_[i % slices_.size()];
    if (taken.kind != given_out.kind || taken.bytes.size != given_out.bytes.size) continue;
    if (!compare(taken.bytes.data, given_out.bytes, differences)) continue;
    first_ = i + 1;
    return taken.bytes.data;
  }
  return nullptr;
}

}  // namespace limb_ring::recorder
