#include "recorder/slices_taken_in.h"

#include <algorithm>
#include <cstring>

namespace limb_ring::recorder {
namespace {

/// Header and trailer, with what a relay changes in them, lie in the first and the last bytes of a slice: HOP, FBC and
/// CRC.
constexpr std::size_t kMayDiffer = 16;

/// @return false where there are more than have room
bool add_differences(const std::uint8_t* from, wire::ByteView to, std::size_t begin, std::size_t end,
                     Differences& found) {
  for (std::size_t at = begin; at < end; ++at) {
    if (from[at] == to[at]) continue;
    if (found.count == found.bytes.size()) return false;
    found.bytes[found.count++] = {static_cast<std::uint16_t>(at), to[at]};
  }
  return true;
}

/// @pre both are of the same size
/// @return false where more differs than has room, or anything between the first and the last bytes
bool compare(const std::uint8_t* from, wire::ByteView to, Differences& found) {
  found.count = 0;
  const std::size_t head = std::min(to.size, kMayDiffer);
  const std::size_t tail = std::max(head, to.size - head);
  return std::memcmp(from + head, to.data + head, tail - head) == 0 && add_differences(from, to, 0, head, found) &&
         add_differences(from, to, tail, to.size, found);
}

}  // namespace

const std::uint8_t* SlicesTakenIn::find(const wire::Slice& given_out, Differences& differences) {
  if (given_out.bytes.empty()) return nullptr;
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
