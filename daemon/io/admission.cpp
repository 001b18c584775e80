#include "io/admission.h"

#include <algorithm>

namespace limb_ring::link {

std::string why_unfit(const LinkHeader& connect, const LinkHeader& refuse) {
  switch (refuse.refusal) {
    case Refusal::wrong_version:
      return version_mismatch(connect.version);
    case Refusal::invalid_memory:
      return "it offers shared memory that cannot be used";
    case Refusal::needs_key:
      return "it has no key, and the lines here are keyed: give links.key in its file";
    case Refusal::no_key:
      return "it has a key, and this node has none: give links.key in the file here";
    case Refusal::not_in_ring:
      return "it is not in this ring";
    default:
      return reason_of(refuse);
  }
}

Admission::Admission(Identity self, std::vector<std::uint8_t> order, std::vector<std::string> names)
    : self_(self), order_(std::move(order)), names_(std::move(names)) {}

Refusal Admission::judge(const LinkHeader& connect, std::optional<std::uint8_t> present) const {
  if (connect.version != kLinkVersion) return Refusal::wrong_version;
  if (connect.ring != self_.ring) return Refusal::wrong_ring;
  const std::size_t asking = distance(connect.sender);
  if (asking == 0) return Refusal::not_in_ring;
  if (present && asking > distance(*present)) return Refusal::busy;
  return Refusal::none;
}

std::optional<LinkHeader> Admission::judge(const LinkHeader& connect, const Agreement& theirs,
                                           std::optional<std::uint8_t> present) const {
  const Refusal refusal = judge(connect, present);
  if (refusal == Refusal::wrong_version || refusal == Refusal::wrong_ring)
    return header(LinkHeaderType::refuse, refusal);
  if (const std::uint32_t differing = differences(self_.agreement, theirs)) {
    LinkHeader refuse = header(LinkHeaderType::refuse, Refusal::other_ring_file);
    refuse.sequence = differing;
    return refuse;
  }
  if (refusal == Refusal::none) return {};
  return header(LinkHeaderType::refuse, refusal);
}

LinkHeader Admission::header(LinkHeaderType type, Refusal refusal) const {
  LinkHeader header;
  header.type = type;
  header.ring = self_.ring;
  header.sender = self_.id;
  header.refusal = refusal;
  return header;
}

std::string Admission::label(std::uint8_t node) const {
  const auto at = static_cast<std::size_t>(std::find(order_.begin(), order_.end(), node) - order_.begin());
  return "node " + std::to_string(node) + (at < names_.size() ? " (" + names_[at] + ")" : "");
}

std::size_t Admission::distance(std::uint8_t from) const {
  const auto us = std::find(order_.begin(), order_.end(), self_.id);
  const auto them = std::find(order_.begin(), order_.end(), from);
  if (us == order_.end() || them == order_.end()) return 0;
  const auto step = us - them;
  return static_cast<std::size_t>(step > 0 ? step : step + static_cast<long>(order_.size()));
}

}  // namespace limb_ring::link
