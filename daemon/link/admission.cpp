#include "link/admission.h"

#include <algorithm>

namespace limb_ring::link {

std::string why_unfit(const LinkHeader& connect, Refusal refusal) {
  const std::string node = "node " + std::to_string(connect.sender);
  if (refusal == Refusal::wrong_version) return node + ": " + version_mismatch(connect.version);
  if (refusal == Refusal::invalid_memory) return node + " offers shared memory that cannot be used";
  if (refusal == Refusal::wrong_ring) return node + " belongs to another ring";
  return node + " is not in this ring";
}

Admission::Admission(Identity self, std::vector<std::uint8_t> order) : self_(self), order_(std::move(order)) {}

Refusal Admission::judge(const LinkHeader& connect, std::optional<std::uint8_t> present) const {
  if (connect.version != kLinkVersion) return Refusal::wrong_version;
  if (connect.ring != self_.ring) return Refusal::wrong_ring;
  const std::size_t asking = distance(connect.sender);
  if (asking == 0) return Refusal::not_in_ring;
  if (present && asking > distance(*present)) return Refusal::busy;
  return Refusal::none;
}

std::size_t Admission::distance(std::uint8_t from) const {
  const auto us = std::find(order_.begin(), order_.end(), self_.id);
  const auto them = std::find(order_.begin(), order_.end(), from);
  if (us == order_.end() || them == order_.end()) return 0;
  const auto step = us - them;
  return static_cast<std::size_t>(step > 0 ? step : step + static_cast<long>(order_.size()));
}

}  // namespace limb_ring::link
