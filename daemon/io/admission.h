#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/endpoint.h"
#include "io/link_header.h"

namespace limb_ring::link {

/// Why a node that asked to connect was refused, other than for being farther away; for people. "It" is that node.
std::string why_unfit(const LinkHeader& connect, const LinkHeader& refuse);

/// Who may be our upstream neighbour (ours, protocol.md section 6.8): the nearest living node in ring order. So a node
/// that is at least as near as the present neighbour takes its place; the same id again is a restart.
class Admission {
 public:
  /// @param order all node ids in ring order, `self.id` among them
  /// @param names of the nodes, in the same order; for messages, may be empty
  Admission(Identity self, std::vector<std::uint8_t> order, std::vector<std::string> names = {});

  /// @param present the upstream neighbour we have and still hear, if any
  /// @return Refusal::none where the sender of `connect` may come in
  Refusal judge(const LinkHeader& connect, std::optional<std::uint8_t> present) const;
  /// The same for a node that has also told what it expects of our ring file (`theirs`).
  /// @return the `refuse` header to be answered; nothing where it may come in
  std::optional<LinkHeader> judge(const LinkHeader& connect, const Agreement& theirs,
                                  std::optional<std::uint8_t> present) const;

  /// A header of ours.
  LinkHeader header(LinkHeaderType type, Refusal refusal = Refusal::none) const;
  /// For people: "node 3 (neck)".
  std::string label(std::uint8_t node) const;

 private:
  /// Nodes between `from` and us, going upstream: 1 is our neighbour, we ourselves are the
  /// farthest. 0: no node of the ring.
  std::size_t distance(std::uint8_t from) const;

  Identity self_;
  std::vector<std::uint8_t> order_;
  std::vector<std::string> names_;
};

}  // namespace limb_ring::link
