#include "tools/ringctl/choose_ring.h"

#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "config/names.h"
#include "limb_ring/ring_directory.h"
#include "ring/lock_files.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/ring_folder.h"

namespace limb_ring::ringctl {

namespace {

/// Who has come by sudo most likely means a ring of his own.
std::string whose_else() {
  const char* user = std::getenv("SUDO_USER");
  if (::geteuid() != 0 || user == nullptr || *user == '\0') return "";
  return std::string("; these are root's rings, those of ") + user + " are seen without sudo";
}

std::string valid(const std::string& ring) {
  try {
    ring_directory(ring);
  } catch (const std::invalid_argument& problem) {
    throw UsageError(problem.what());
  }
  return ring;
}

}  // namespace

std::string named_ring(const std::string& given) {
  if (!given.empty()) return valid(given);
  const char* environment = std::getenv("LIMB_RING_RING");
  return environment != nullptr && *environment != '\0' ? valid(environment) : "";
}

std::string choose_ring(const std::string& given) {
  const std::string named = named_ring(given);
  if (!named.empty()) return named;
  std::vector<std::string> rings = running_rings();
  if (rings.empty()) rings = live::held_rings();  // their daemons live, but none can be connected to
  if (rings.empty()) {
    const std::vector<std::string> killed = live::killed_rings();
    if (killed.size() == 1) return killed.front();
    const std::string unreadable = why_unreadable(rings_directory());
    if (!unreadable.empty()) throw NoRing(rings_directory() + unreadable);
    throw NoRing("no ring is running (looked in " + rings_directory() + ")" + whose_else());
  }
  if (rings.size() == 1) return rings.front();
  throw UsageError("several rings are running: " + config::join(rings) + "; choose one with --ring");
}

std::string choose_ring(const std::string& argument, const std::string& option) {
  if (!argument.empty() && !option.empty() && argument != option) throw UsageError("RING and --ring name two rings");
  return choose_ring(argument.empty() ? option : argument);
}

}  // namespace limb_ring::ringctl
