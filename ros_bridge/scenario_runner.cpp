#include "ros_bridge/scenario_runner.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

namespace limb_ring::bridge {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kTick{20};

/// For the files of one run; removed with all in it.
class Folder {
 public:
  Folder() {
    path_ = (fs::temp_directory_path() / "limb_ring_scenario_XXXXXX").string();
    if (::mkdtemp(path_.data()) == nullptr)
      throw std::system_error(errno, std::generic_category(), "cannot make a folder " + path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string file(const char* name) const { return path_ + '/' + name; }

 private:
  std::string path_;
};

std::string content(const std::string& file) {
  std::ostringstream text;
  if (std::ifstream in(file); in.peek() != std::ifstream::traits_type::eof()) text << in.rdbuf();
  return text.str();
}

std::string file_of(const ScenarioOrder& order, const Folder& folder) {
  if (order.path.empty() == order.text.empty())
    throw std::invalid_argument("give either path, a scenario's file, or text, its YAML");
  if (!order.path.empty()) return order.path;
  std::ofstream(folder.file("scenario.yaml")) << order.text;
  return folder.file("scenario.yaml");
}

std::vector<std::string> arguments_of(const ScenarioOrder& order, const Folder& folder) {
  std::vector<std::string> arguments{
      "ringctl", "scenario", "run", order.live ? "--live" : "--sim", "--junit", folder.file("junit.xml")};
  if (order.seed != 0) arguments.insert(arguments.end(), {"--seed", std::to_string(order.seed)});
  arguments.insert(arguments.end(), {"--", file_of(order, folder)});  // a path is no option
  return arguments;
}

/// @param report where its output and errors go
pid_t start_ringctl(std::vector<std::string> arguments, const std::string& report) {
  const std::string program = fs::read_symlink("/proc/self/exe").parent_path() / arguments[0];
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, report.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ::posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  pid_t pid = -1;
  const int error = ::posix_spawn(&pid, program.c_str(), &files, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw std::system_error(error, std::generic_category(), "cannot start " + program);
  return pid;
}

/// ringctl's own deadlines end it.
int wait_for(pid_t pid, const std::function<bool()>& go_on) {
  int status = 0;
  bool interrupted = false;
  while (::waitpid(pid, &status, WNOHANG) == 0) {
    if (!interrupted && !go_on()) {
      ::kill(pid, SIGINT);
      interrupted = true;
    }
    std::this_thread::sleep_for(kTick);
  }
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  throw std::runtime_error("ringctl was ended by signal " + std::to_string(WTERMSIG(status)));
}

}  // namespace

ScenarioEnd play_scenario(const ScenarioOrder& order, const std::function<bool()>& go_on) {
  const Folder folder;
  ScenarioEnd end;
  end.exit_code = wait_for(start_ringctl(arguments_of(order, folder), folder.file("report")), go_on);
  end.report = content(folder.file("report"));
  end.junit = content(folder.file("junit.xml"));
  return end;
}

}  // namespace limb_ring::bridge
