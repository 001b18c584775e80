#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/ring_sim/command_line.h"

namespace limb_ring::ring_sim {

/// What ring_sim said to a command line, and ended with.
struct Said {
  int code = -1;
  std::string out, errors;
};

inline Said ring_sim(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "ring_sim");
  std::vector<char*> argv;
  for (auto& argument : arguments) argv.push_back(argument.data());
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const int code = run_command_line(static_cast<int>(argv.size()), argv.data());
  const std::string out = ::testing::internal::GetCapturedStdout();
  return {code, out, ::testing::internal::GetCapturedStderr()};
}

}  // namespace limb_ring::ring_sim
