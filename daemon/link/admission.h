#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "link/endpoint.h"
#include "link/link_header.h"

namespace limb_ring::link {

/// Why a node that asked to connect was refused, other than for being farther away; for people.
std::string why_unfit(const LinkHeader& connect, Refusal refusal);

/// Who may be our upstream neighbour (ours, protocol.md section 6.8). The nearest living node in ring order is; so one
/// that is at least as near as the present one takes its place: the same id is a restart.
class Admission {
 public:
  /// @param order all node ids in ring order, `self.id` among them
  Admission(Identity self, std::vector<std::uint8_t> order);

  /// @param present the upstream neighbour we have and still hear, if any
  /// @return Refusal::none where the sender of `connect` may come in
  Refusal judge(const LinkHeader& connect, std::optional<std::uint8_t> present) const;

 private:
  /// Nodes between `from` and us, going upstream: 1 is our neighbour, we ourselves are the
  /// farthest. 0: no node of the ring.
  std::size_t distance(std::uint8_t from) const;

  Identity self_;
  std::vector<std::uint8_t> order_;
};

}  // namespace limb_ring::link
