#include "recorder/slices_taken_in.h"

#include <algorithm>
#include <cstring>

namespace limb_ring::recorder {
namespace {

using Word = std::uint64_t;
constexpr std::size_t kBlock = 4 * sizeof(Word);  ///< looked at at once

Word difference(const std::uint8_t* a, const std::uint8_t* b) {
  Word first, second;
  std::memcpy(&first, a, sizeof first);
  std::memcpy(&second, b, sizeof second);
  return first ^ second;
}

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
bool compare(const std::uint8_t* from, wire::ByteView to, Differences& found) {
  found.count = 0;
  std::size_t at = 0;
  for (; at + kBlock <= to.size; at += kBlock) {
    Word words[4];
    for (std::size_t i = 0; i < 4; ++i)
      words[i] = difference(from + at + i * sizeof(Word), to.data + at + i * sizeof(Word));
    if ((words[0] | words[1] | words[2] | words[3]) == 0) continue;
    for (std::size_t i = 0; i < 4; ++i)
      if (words[i] != 0 && !add_differences(from, to, at + i * sizeof(Word), at + (i + 1) * sizeof(Word), found))
        return false;
  }
  return add_differences(from, to, at, to.size, found);
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
