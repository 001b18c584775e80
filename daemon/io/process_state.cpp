#include "io/process_state.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

namespace limb_ring::process {

// The program's name before it, in brackets, may hold any character.
char state_in(std::istream& stat) {
  // getline() ends where the process is gone by now; an istreambuf_iterator would throw.
  std::string text;
  std::getline(stat, text, '\0');
  const std::size_t state = text.rfind(')');
  return state == std::string::npos || state + 2 >= text.size() ? '\0' : text[state + 2];
}

char process_state(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  return state_in(stat);
}

std::optional<std::chrono::nanoseconds> time_not_asleep(pid_t pid) {
  std::optional<std::chrono::nanoseconds> all;
  std::error_code gone;
  for (std::filesystem::directory_iterator task("/proc/" + std::to_string(pid) + "/task", gone), end;
       !gone && task != end; task.increment(gone)) {
    std::ifstream file(task->path() / "schedstat");
    std::int64_t ran = 0, queued = 0;
    if (file >> ran >> queued) all = all.value_or(std::chrono::nanoseconds(0)) + std::chrono::nanoseconds(ran + queued);
  }
  return all;
}

std::string program_of(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/comm");
  std::string name;
  std::getline(file, name);
  return name;
}

}  // namespace limb_ring::process

// Older C libraries know neither the wrappers nor the numbers; these are the same on every
// architecture but alpha.
#ifndef SYS_pidfd_open
#define SYS_pidfd_open 434
#endif
#ifndef SYS_pidfd_send_signal
#define SYS_pidfd_send_signal 424
#endif

namespace limb_ring::process {

int open_pidfd(pid_t pid) {
  return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));  // close-on-exec by itself
}

ProcessHandle::ProcessHandle(pid_t pid, By by) : pid_(pid) {
  if (by == By::number || pid <= 0) return;
  fd_.reset(open_pidfd(pid));
  if (!fd_.valid() && errno == ESRCH) pid_ = -1;
}

bool ProcessHandle::ended() const {
  if (pid_ <= 0) return true;
  if (!fd_.valid()) return ::kill(pid_, 0) != 0 && errno == ESRCH;
  pollfd exited{fd_.get(), POLLIN, 0};
  return ::poll(&exited, 1, 0) == 1;
}

bool ProcessHandle::signal(int number) const {
  if (pid_ <= 0) return false;
  if (!fd_.valid()) return ::kill(pid_, number) == 0;
  return ::syscall(SYS_pidfd_send_signal, fd_.get(), number, nullptr, 0) == 0;
}

void tell_ready(const std::string& status) {
  const char* where = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  if (where == nullptr || (where[0] != '/' && where[0] != '@') || std::strlen(where) >= sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, where);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(where));
  if (where[0] == '@') address.sun_path[0] = '\0';  // a name without a file
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return;
  const std::string message = "READY=1\nSTATUS=" + status + "\n";
  // Nobody there to hear it: nothing that could be done.
  [[maybe_unused]] const auto sent =
      ::sendto(fd, message.data(), message.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address), size);
  ::close(fd);
}

bool empty_long_log(const std::string& folder, off_t most) {
  namespace fs = std::filesystem;
  struct stat info {};
  if (::fstat(STDERR_FILENO, &info) != 0 || !S_ISREG(info.st_mode) || info.st_size <= most) return false;
  // Who does not append would go on where it was, behind a hole.
  if ((::fcntl(STDERR_FILENO, F_GETFL) & O_APPEND) == 0) return false;
  std::error_code error;
  const fs::path path = fs::read_symlink("/proc/self/fd/2", error);
  return !error && fs::equivalent(path.parent_path(), folder, error) && ::ftruncate(STDERR_FILENO, 0) == 0;
}

}  // namespace limb_ring::process
