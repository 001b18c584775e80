#pragma once

#include <functional>
#include <string>

#include "io/unique_fd.h"

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

/// A text that outlives its writer: of this process and of those that it starts by fork, one after the other.
class KeptText {
 public:
  /// Empty. Where the system has no room for it, it stays so.
  KeptText();
  void put(const std::string& text) const;
  std::string get() const;

 private:
  process::UniqueFd file_;
};

/// The Bridge of this ROS node, by the node's own parameters, until ROS ends. Apart from Bridge, whose header takes
/// seconds to compile.
/// @param kept holds those parameters for the next life of this node: a ROS master that is new by then knows none
/// @throw as read_parameters()
void run_bridge(const KeptText& kept);

/// Runs `program` in a child process, and again whenever that ends, since a reset of its node kills a bridge.
/// roslaunch's own respawn would also restart, for ever, a bridge with wrong parameters.
///
/// Ends where this process is asked to (SIGINT, SIGTERM, SIGHUP: passed on to the child), where the child ends with 2:
/// with wrong parameters another try would end the same way, and with its child where whoever started it is gone: of a
/// roslaunch that was killed nobody else would end it.
/// @pre this process has one thread
/// @return exit code of the last child
int respawned(const std::function<int()>& program);

}  // namespace limb_ring::bridge
