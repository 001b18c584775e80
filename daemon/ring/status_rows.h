#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace limb_ring::ask {

/// How long a daemon may take to answer when rows are polled.
constexpr std::chrono::milliseconds kRowTimeout{500};

/// A node by both its names.
struct Node {
  std::uint8_t id = 0;
  std::string name;
};

/// Status rows, by node id.
using Rows = std::map<std::uint8_t, nlohmann::json>;

/// The status rows of those daemons on this host that answer. All are asked at the same time.
/// @param timeout for each; one that is stopped (SIGSTOP) is not asked
Rows status_rows(const std::string& ring, const std::vector<Node>& nodes, std::chrono::milliseconds timeout);

/// The same of all daemons on this host.
Rows status_rows_here(const std::string& ring, std::chrono::milliseconds timeout);

/// The beacon of a node that the daemon of this row has heard within the last second (an entry of `heard`); null if it
/// has heard none.
nlohmann::json lately_heard_in(const nlohmann::json& row, std::uint8_t node);
/// The newest of those that the daemons of this host have lately heard; null if none has.
nlohmann::json lately_heard(const Rows& rows, std::uint8_t node);

/// A node with a daemon on this host whose packets arrive at `target`, as its beacons do: in an open chain one before
/// it, round a fold one of its part. Nothing where the target's daemon does not answer here, or hears no such node.
std::optional<std::uint8_t> who_reaches(const Rows& rows, std::uint8_t target);

/// The name of a node, or its id where it is none of these.
std::string name_of(const std::vector<Node>& nodes, std::uint8_t id);

}  // namespace limb_ring::ask
