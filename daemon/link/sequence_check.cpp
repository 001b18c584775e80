#include "link/sequence_check.h"

namespace limb_ring::link {

SequenceCheck::Verdict SequenceCheck::check(std::uint32_t sequence) {
  const std::uint32_t ahead = sequence - next_;
  if (ahead >= 0x80000000u) return {false, 0};
  next_ = sequence + 1;
  return {true, ahead};
}

}  // namespace limb_ring::link
