#pragma once

#include <set>
#include <string>

namespace limb_ring::bench {

/// Writes the file of a ring of nodes 0, 1, 2 ... @param sections further sections of the file, each ends its line
/// @param attached nodes whose CPU attaches itself; the others have none
/// @return `path`
std::string write_ring(const std::string& path, unsigned nodes, const std::string& sections,
                       const std::set<unsigned>& attached = {});

}  // namespace limb_ring::bench
