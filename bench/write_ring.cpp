#include "bench/write_ring.h"

#include <fstream>

namespace limb_ring::bench {

std::string write_ring(const std::string& path, unsigned nodes, const std::string& sections,
                       const std::set<unsigned>& attached) {
  std::ofstream file(path);
  file << "ring: bench\n" << sections << "nodes:\n";
  for (unsigned id = 0; id < nodes; ++id) {
    const char* const cpu = attached.count(id) != 0 ? "attached" : "none";
    file << "  - {id: " << id << ", name: node" << id << ", cpu: " << cpu << "}\n";
  }
  return path;
}

}  // namespace limb_ring::bench
