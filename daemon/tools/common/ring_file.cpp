#include "tools/common/ring_file.h"

#include <cstdlib>
#include <filesystem>

#include "config/config_error.h"
#include "io/find_program.h"

namespace limb_ring::app {

namespace {

namespace fs = std::filesystem;

/// The user's own: as the XDG base directories have it. Empty where neither is known.
fs::path users_folder() {
  const char* config = std::getenv("XDG_CONFIG_HOME");
  if (config != nullptr && config[0] == '/') return fs::path(config) / "limb_ring";
  const char* home = std::getenv("HOME");
  return home == nullptr || home[0] == '\0' ? fs::path() : fs::path(home) / ".config" / "limb_ring";
}

/// PREFIX/share/limb_ring/config, the programs being in PREFIX/lib/limb_ring.
fs::path own_files() {
  const fs::path folder = process::own_folder();
  return folder.parent_path().parent_path() / "share" / "limb_ring" / "config";
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

}  // namespace

std::string ring_file(const std::string& given) {
  if (given.find_first_of("/.") != std::string::npos || is_file(given)) return given;
  std::string looked_in;
  for (const fs::path& folder : {users_folder(), fs::path("/etc/limb_ring"), own_files()}) {
    if (folder.empty()) continue;
    const fs::path path = folder / (given + ".yaml");
    if (is_file(path)) return path.string();
    looked_in += (looked_in.empty() ? "" : ", ") + folder.string();
  }
  throw config::ConfigError("there is no file " + given + ", and no ring " + given + ".yaml in " + looked_in);
}

}  // namespace limb_ring::app
