#include "io/process_state.h"

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
