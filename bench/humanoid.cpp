#include "bench/humanoid.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace limb_ring::bench {
namespace {

void replace(std::string& text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  if (at == std::string::npos) throw std::runtime_error("humanoid16.yaml has no '" + before + "' any more");
  text.replace(at, before.size(), after);
}

}  // namespace

std::string write_humanoid(const Setup& setup, const live::PrivateFolder& folder, unsigned state_rate,
                           const std::string& bridge) {
  std::ostringstream text;
  text << std::ifstream(setup.humanoid).rdbuf();
  std::string ring = text.str();
  replace(ring, "state_rate: 100 ", "state_rate: " + std::to_string(state_rate) + " ");
  replace(ring, "bridge:\n  rate: 50 ", "bridge:\n  " + bridge + " ");
  const std::string path = folder.path() + "/humanoid" + std::to_string(state_rate) + ".yaml";
  std::ofstream(path) << ring;
  return path;
}

}  // namespace limb_ring::bench
