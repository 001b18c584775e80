#include "io/exit_status.h"

#include <sys/wait.h>

#include <cstring>
#include <system_error>
#include <utility>

namespace limb_ring::process {

ExitStatus exit_status(int wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const int number = WTERMSIG(wait_status);
    return {true, false, true, "signal " + std::to_string(number) + " (" + ::strsignal(number) + ")", {}};
  }
  const int code = WEXITSTATUS(wait_status);
  return {true, code == 0, false, "exit " + std::to_string(code), code};
}

ExitStatus unknown_status() { return {true, false, false, "ended, status unknown (SIGCHLD is ignored)", {}}; }

ExitStatus not_executed(const std::string& path, int error) {
  return not_started("cannot execute " + path + ": " + std::generic_category().message(error));
}

ExitStatus not_started(std::string why) { return {false, false, false, std::move(why), {}}; }

}  // namespace limb_ring::process
