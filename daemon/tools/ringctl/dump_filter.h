#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "wire/pcapng_writer.h"
#include "wire/selection.h"

namespace limb_ring::ringctl {

/// The words for the ends of a line, and for capture::Kind.
inline const std::vector<std::string> kLines{"in", "out"};
inline const std::vector<std::string> kKinds{"data", "control", "interrupt"};

/// Which packets a command line asks for, in its own words.
struct FilterWords {
  std::vector<std::string> at, kinds, from, to;
  std::vector<unsigned> priority, channel;
  std::uint32_t sample = 1, limit = 0;
};

/// Id of a node by id or name. @throw UsageError listing those there are
wire::NodeId node_of(const std::string& word, const capture::RingNames& names);

/// @throw UsageError naming the word that is wrong, and what there is
capture::Choice choice_of(const FilterWords& words, const capture::RingNames& names);

/// As `packets` of an observe order (docs/reference/requests.md).
nlohmann::json order_of(const capture::Choice& choice);

}  // namespace limb_ring::ringctl
