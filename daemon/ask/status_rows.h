#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limb_ring::ask {

/// How long a daemon may take to answer when rows are polled.
constexpr std::chrono::milliseconds kRowTimeout{500};

struct Node {
  std::uint8_t id = 0;
  std::string name;
};

/// The status rows of those daemons on this host that answer, by node id. All are asked at the same time.
/// @param timeout for each; one that is stopped (SIGSTOP) is not asked
using Rows = std::map<std::uint8_t, nlohmann::json>;
Rows status_rows(const std::string& ring, const std::vector<Node>& nodes, std::chrono::milliseconds timeout);

/// The same of all daemons on this host.
Rows status_rows_here(const std::string& ring, std::chrono::milliseconds timeout);

/// The newest beacon of a node that a daemon of this host has lately heard (an entry of `heard` in its row); null if
/// none has.
nlohmann::json lately_heard(const Rows& rows, std::uint8_t node);

/// The name of a node, or its id where it is none of these.
std::string name_of(const std::vector<Node>& nodes, std::uint8_t id);

}  // namespace limb_ring::ask
