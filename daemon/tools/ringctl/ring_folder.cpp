#include "tools/ringctl/ring_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

#include "io/unique_fd.h"
#include "judge/flight_recorder.h"
#include "limb_ring/host_port.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kEndTick{20};
constexpr milliseconds kLongestEnd{3000};  // a daemon ends its CPU first

}  // namespace

RingFolder::RingFolder(const std::string& ring)
    : path_(ring_directory(ring)), opened_(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (!opened_.valid() && errno != ENOENT) process::throw_errno("cannot look into " + path_);
}

// The folder stays where somebody has put a file into it.
bool RingFolder::is_gone() const {
  struct stat folder {};
  if (::fstat(opened_.get(), &folder) != 0 || folder.st_nlink == 0) return true;
  try {
    return live::known_nodes(path_).empty();
  } catch (const std::system_error&) {  // it is there, but there is no descriptor left to look into it
    return false;
  }
}

std::vector<std::uint8_t> node_sockets(const std::string& ring) {
  std::vector<std::uint8_t> ids;
  for (const std::string& file : live::files_in(ring_directory(ring)))
    if (const auto id = live::node_of(file, ".host")) ids.push_back(*id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

// A daemon that holds a lock wrote its own pid into it: nobody else is hit.
void signal_daemons(const std::string& folder, int number) {
  for (const live::HeldNode& node : live::held_nodes(folder))
    if (node.pid > 0) ::kill(node.pid, number);
}

void terminate_daemons(const std::string& folder) {
  signal_daemons(folder, SIGTERM);
  signal_daemons(folder, SIGCONT);  // one that is stopped would not see it
}

bool wait_until_gone(const std::string& folder, Progress& progress) {
  const auto deadline = steady_clock::now() + kLongestEnd;
  for (;;) {
    const auto held = live::held_nodes(folder);
    if (held.empty()) return true;
    if (steady_clock::now() >= deadline) return false;
    progress.tell("waiting for " + app::counted(held.size(), "daemon") + " to end");
    std::this_thread::sleep_for(kEndTick);
  }
}

void tidy_folder(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  if (live::held_nodes(folder).empty() && recorder::recordings_in(folder).empty()) live::remove_leftovers(folder);
}

std::string why_unreadable(const std::string& folder) {
  std::error_code error;
  fs::directory_iterator(folder, error);
  if (error && error != std::errc::no_such_file_or_directory) return ": " + error.message();
  const std::string problem = why_not_private(folder);
  return problem.empty() ? "" : ": " + problem;
}

void tell_unreadable(const std::string& folder) {
  for (const std::string& problem : live::unreadable_files(folder)) tell_user(problem);
}

void tell_unreadable_rings() {
  const std::string folder = rings_directory(), problem = why_unreadable(folder);
  if (!problem.empty()) tell_user(folder + problem);
}

}  // namespace limb_ring::ringctl
