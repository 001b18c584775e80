#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace limb_ring {

/// What a program said to a command line, and ended with.
struct CliRun {
  int code = -1;
  std::string out, errors;
};

/// Runs a program's command line in this process; `arguments` begin with the program's name.
template <typename CommandLine>
CliRun run_cli(const CommandLine& run, std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (auto& argument : arguments) argv.push_back(argument.data());
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const int code = run(static_cast<int>(argv.size()), argv.data());
  const std::string out = ::testing::internal::GetCapturedStdout();
  return {code, out, ::testing::internal::GetCapturedStderr()};
}

}  // namespace limb_ring
