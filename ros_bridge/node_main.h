#pragma once

#include <functional>

namespace limb_ring::bridge {

/// What the main() of a ROS node needs to know of it.
struct NodeProgram {
  const char* name;           ///< of the node, where nobody remaps it
  const char* help;           ///< for --help: what it does, its parameters
  std::function<void()> run;  ///< until ROS ends; what keeps it from starting is thrown
};

/// Runs a ROS node. What keeps it from starting is said by rosconsole, so on standard error, too.
/// A node of the same name that lives is such a reason.
/// @return exit code: 0 ended as asked, 1 could not run, 2 wrong arguments, parameters or configuration
int run_node(int argc, char** argv, const NodeProgram& program);

}  // namespace limb_ring::bridge
