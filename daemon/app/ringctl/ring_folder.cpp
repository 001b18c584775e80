#include "app/ringctl/ring_folder.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "limb_ring/host_port.h"
#include "limb_ring/ring_directory.h"
#include "live/lock_files.h"

namespace limb_ring::ringctl {

namespace fs = std::filesystem;

namespace {

/// The id in "12.host"; nothing for another file, such as the link of the node's name.
std::optional<std::uint8_t> socket_id(const fs::path& file) {
  const std::string stem = file.stem().string();
  const bool number = !stem.empty() && stem.size() <= 3 && stem.find_first_not_of("0123456789") == std::string::npos;
  if (file.extension() != ".host" || !number || std::stoul(stem) >= kBroadcast) return {};
  return static_cast<std::uint8_t>(std::stoul(stem));
}

}  // namespace

RingFolder::RingFolder(const std::string& ring)
    : path_(ring_directory(ring)), opened_(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}

// The folder stays where somebody has put a file into it.
bool RingFolder::is_gone() const {
  struct stat folder {};
  if (::fstat(opened_.get(), &folder) != 0 || folder.st_nlink == 0) return true;
  return live::known_nodes(path_).empty();
}

std::vector<std::uint8_t> node_sockets(const std::string& ring) {
  std::vector<std::uint8_t> ids;
  std::error_code error;
  const fs::directory_iterator folder(ring_directory(ring), error);
  for (auto it = fs::begin(folder); !error && it != fs::end(folder); it.increment(error))
    if (const auto id = socket_id(it->path())) ids.push_back(*id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::string why_unreadable(const std::string& folder) {
  std::error_code error;
  fs::directory_iterator(folder, error);
  return error && error != std::errc::no_such_file_or_directory ? ": " + error.message() : "";
}

}  // namespace limb_ring::ringctl
