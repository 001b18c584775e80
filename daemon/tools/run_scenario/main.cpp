// run_scenario: 'ringctl scenario run' for a <test> of rostest. The JUnit report goes to the path that rostest gives.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "io/program.h"
#include "tools/ringctl/screen.h"

namespace {

const std::string kResult = "--gtest_output=xml:";

std::vector<std::string> ringctl_arguments(int argc, char** argv) {
  std::vector<std::string> arguments{"ringctl", "scenario", "run"};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.rfind(kResult, 0) != 0) {
      arguments.push_back(argument);
      continue;
    }
    arguments.insert(arguments.end(), {"--junit", argument.substr(kResult.size())});
  }
  return arguments;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string program = limb_ring::process::find_program("ringctl");
  const int error = program.empty() ? ENOENT : limb_ring::process::execute(program, ringctl_arguments(argc, argv));
  std::fprintf(stderr, "run_scenario: no program ringctl beside it (%s) or on PATH: %s\n",
               limb_ring::process::own_folder().c_str(), std::strerror(error));
  return limb_ring::ringctl::kNotDone;
}
