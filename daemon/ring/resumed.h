#pragma once

#include <functional>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "ring/status_rows.h"

namespace limb_ring::ask {

/// What came of the resume of one node.
struct Resumed {
  Node node;
  Result result;
  bool was_latched = false, is_latched = false;
  bool seen = false;  ///< its daemon, or a beacon of it, tells that no stop is latched there any more

  bool done() const { return !is_latched && (result.outcome == Outcome::delivered || (was_latched && seen)); }
};

/// Sends a resume from the node with this id, and waits for its result.
using SendResume = std::function<Result(std::uint8_t from)>;

/// A resume that one node has sent, with this result: where that does not reach its target, it is sent from a node of
/// this host that does. @return the result that counts
Result resume_from_nearer(const std::string& ring, std::uint8_t target, const Result& result, const SendResume& send);

/// Fills in what can be seen of them, for which it waits 1 s at most: of a command that was not confirmed, it alone
/// tells. @param nodes all of the ring
void look_at(const std::string& ring, const std::vector<Node>& nodes, std::vector<Resumed>& all);

bool is_among(const std::vector<Node>& nodes, std::uint8_t id);

}  // namespace limb_ring::ask
