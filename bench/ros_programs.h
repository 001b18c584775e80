#pragma once

#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/setup.h"
#include "io/program.h"
#include "ring/private_folder.h"

namespace limb_ring::bench {

/// Programs of ROS with a master of their own; they end with this object.
class RosPrograms {
 public:
  /// Starts the master. @throw std::runtime_error where it cannot
  RosPrograms(const Setup& setup, const live::PrivateFolder& folder);
  ~RosPrograms();
  RosPrograms(const RosPrograms&) = delete;
  RosPrograms& operator=(const RosPrograms&) = delete;

  /// @return it; stays where it is. @throw std::runtime_error where there is no such program
  process::Program& start(const std::string& program, const std::vector<std::string>& arguments,
                          const std::optional<cpu_set_t>& cores = {});
  /// Waits until it has ended and reads the JSON it printed.
  /// @throw std::runtime_error with its last lines where it printed none, or takes longer than a minute
  nlohmann::json result_of(process::Program& program);

  /// Why a measurement that needs `own_program` and ROS cannot be made; empty where it can.
  static std::string missing(const Setup& setup, const std::string& own_program);

 private:
  const Setup& setup_;
  const live::PrivateFolder& folder_;
  std::string port_;
  std::deque<process::Program> programs_;
};

}  // namespace limb_ring::bench
