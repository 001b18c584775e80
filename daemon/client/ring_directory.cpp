#include "limb_ring/ring_directory.h"

#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "client/frame.h"

namespace limb_ring {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxSocketPath = sizeof(sockaddr_un::sun_path) - 1;
constexpr mode_t kOwnerOnly = 0700;
constexpr mode_t kGroupAndOthers = 0077;

/// On one line, whatever was given; an exception's text would end at a null.
std::string shown(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return name;
}

void require_name(const char* what, const std::string& name) {
  if (is_ring_name(name)) return;
  throw std::invalid_argument(std::string(what) + " '" + shown(name) +
                              "': a name has 1 to 32 letters, digits, '-', '_' or '.', and does "
                              "not begin with '.' or '-'");
}

/// Null if it is not set, or relative: that would be another folder for each program, and XDG's specification has
/// it ignored.
const char* told_runtime() {
  const char* told = std::getenv("XDG_RUNTIME_DIR");
  return told != nullptr && *told == '/' ? told : nullptr;
}

/// @param right what would be right where it cannot be made
void make_private(const std::string& folder, const std::string& right = "") {
  if (mkdir(folder.c_str(), kOwnerOnly) != 0 && errno != EEXIST) {
    throw std::system_error(errno, std::generic_category(), "cannot make the folder " + folder + right);
  }
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0) throw std::system_error(errno, std::generic_category(), folder);
  const std::string problem = why_not_private(folder);
  if (!problem.empty()) throw std::runtime_error(folder + ' ' + problem);
}

/// Root may write into another user's, and a folder of root's would lock that user out of it.
void require_own_runtime(const std::string& runtime) {
  struct stat status {};
  if (geteuid() != 0 || stat(runtime.c_str(), &status) != 0 || status.st_uid == 0) return;
  throw std::runtime_error("XDG_RUNTIME_DIR names " + runtime + ", which belongs to user " +
                           std::to_string(status.st_uid) + ", not to this one (0); unset it, as 'sudo -i' does");
}

bool daemon_answers(const fs::directory_entry& entry) {
  if (entry.path().extension() != ".host" || entry.is_symlink()) return false;
  const std::string path = entry.path().string();
  return path.size() <= kMaxSocketPath && client::UnixSocket::connect(path).has_value();
}

/// Folders may come and go while they are read: an error reads as "nothing more here".
bool any_daemon_answers(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (daemon_answers(*it)) return true;
  }
  return false;
}

}  // namespace

std::string rings_directory(const std::string& runtime) {
  if (!runtime.empty()) return runtime + "/limb_ring";
  if (const char* told = told_runtime(); told != nullptr) return std::string(told) + "/limb_ring";
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  const std::string base = error ? std::string("/tmp") : temporary.string();
  return base + "/limb_ring-" + std::to_string(geteuid());
}

std::string ring_directory(const std::string& ring, const std::string& runtime) {
  require_name("ring", ring);
  return rings_directory(runtime) + "/" + ring;
}

std::string why_not_private(const std::string& folder) {
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0) return "";
  if (S_ISLNK(status.st_mode)) return "is a symbolic link; a folder of this user's own is needed";
  if (!S_ISDIR(status.st_mode)) return "is not a folder";
  if (status.st_uid != geteuid()) {
    return "belongs to user " + std::to_string(status.st_uid) + ", not to this one (" + std::to_string(geteuid()) + ")";
  }
  if ((status.st_mode & kGroupAndOthers) != 0) {
    return "is open to others; mode 0700 is needed (chmod 700 " + folder + ")";
  }
  return "";
}

std::string make_ring_directory(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  // In a container, or behind `su` or `sudo -E`, it may name a folder that is not there, or another user's.
  const bool told = told_runtime() != nullptr;
  if (told) require_own_runtime(told_runtime());
  make_private(rings_directory(),
               told ? " (XDG_RUNTIME_DIR has to name a folder of this user's, or not to be set)" : "");
  make_private(folder);
  return folder;
}

std::vector<std::string> running_rings(const std::string& runtime) {
  std::vector<std::string> rings;
  std::error_code error;
  for (fs::directory_iterator it(rings_directory(runtime), error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (is_ring_name(name) && any_daemon_answers(it->path())) rings.push_back(name);
  }
  std::sort(rings.begin(), rings.end());
  return rings;
}

std::map<std::string, std::string> node_names(const std::string& directory) {
  std::map<std::string, std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != ".host") continue;
    std::error_code no_link;
    const fs::path target = fs::read_symlink(it->path(), no_link);
    if (!no_link && target.extension() == ".host") names[target.stem().string()] = it->path().stem().string();
  }
  return names;
}

std::vector<std::string> nodes_here(const std::string& ring, const std::string& runtime) {
  const std::string folder = ring_directory(ring, runtime);
  std::vector<std::string> ids;
  std::error_code error, gone;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".host" && !it->is_symlink(gone)) ids.push_back(it->path().stem().string());
  std::sort(ids.begin(), ids.end(), [](const std::string& a, const std::string& b) {
    return std::make_pair(a.size(), a) < std::make_pair(b.size(), b);
  });
  const auto names = node_names(folder);
  for (std::string& id : ids)
    if (const auto name = names.find(id); name != names.end()) id = name->second;
  return ids;
}

std::string socket_path(const std::string& directory, const std::string& node, const char* kind) {
  require_name("node", node);
  std::string path = directory + "/" + node + "." + kind;
  if (path.size() <= kMaxSocketPath) return path;
  throw std::invalid_argument("socket path of " + std::to_string(path.size()) + " bytes, at most " +
                              std::to_string(kMaxSocketPath) + " are possible: " + path +
                              " (a shorter XDG_RUNTIME_DIR or ring name helps)");
}

}  // namespace limb_ring
