#include "tools/ringctl/other_host.h"

#include <cstring>
#include <filesystem>

#include "io/execute.h"
#include "io/find_program.h"
#include "tools/common/shell_word.h"
#include "tools/ringctl/names_to_complete.h"
#include "tools/ringctl/tell_user.h"

namespace limb_ring::ringctl {
namespace {

constexpr int kSecondsToConnect = 10;

/// ssh says 255 where it does not get there; that is none of our exit codes.
std::string with_our_codes() {
  return "ssh \"$@\"; code=$?; [ $code -eq 255 ] && exit " + std::to_string(kNoRing) + "; exit $code";
}

}  // namespace

std::vector<std::string> arguments_there(const std::string& ring, std::vector<std::string> arguments) {
  if (!ring.empty() && typed_ring(arguments).empty()) arguments.insert(arguments.begin(), {"--ring", ring});
  return arguments;
}

std::string command_there(const std::string& program, const std::string& folder,
                          const std::vector<std::string>& arguments) {
  std::string command = "cd " + app::shell_word(folder) + " 2>/dev/null; p=" + app::shell_word(program) +
                        "; [ -x \"$p\" ] || p=ringctl; exec \"$p\"";
  for (const std::string& argument : arguments) command += ' ' + app::shell_word(argument);
  return command;
}

int run_there(const Elsewhere& where, const std::vector<std::string>& arguments) {
  std::error_code ignored;
  const std::string command =
      command_there(process::own_folder() + "/ringctl", std::filesystem::current_path(ignored).string(),
                    arguments_there(where.ring, arguments));
  const int error = process::execute(
      "/bin/sh", {"sh", "-c", with_our_codes(), "sh", "-n", "-o", "BatchMode=yes", "-o",
                  "ConnectTimeout=" + std::to_string(kSecondsToConnect), "--", where.destination, command});
  tell_user(std::string("/bin/sh: ") + std::strerror(error));
  return kNoRing;
}

}  // namespace limb_ring::ringctl
