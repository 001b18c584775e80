#pragma once

#include <functional>
#include <string>

#include "io/unique_fd.h"

namespace limb_ring::bridge {

/// What main() needs to know about a ROS node.
struct NodeProgram {
  const char* name;           ///< of the node, if nobody remaps it
  const char* help;           ///< for --help: what it does, its parameters
  std::function<void()> run;  ///< until ROS ends; what keeps it from starting is thrown
};

/// Runs a ROS node. If it cannot start, the reason is logged by rosconsole, so on standard error, too. One such reason
/// is a living node of the same name.
/// @return exit code: 0 ended as asked, 1 could not run, 2 wrong arguments, parameters or configuration
int run_node(int argc, char** argv, const NodeProgram& program);

/// A text in shared memory that outlives the process that wrote it, for this process and those that it forks one after
/// the other.
class KeptText {
 public:
  /// Empty. If the system has no room for it, it stays so.
  KeptText();
  void put(const std::string& text) const;
  std::string get() const;

 private:
  process::UniqueFd file_;
};

/// Runs the Bridge of this ROS node with the node's own parameters until ROS ends. It is declared here because the
/// header of Bridge takes seconds to compile.
/// @param kept holds these parameters for the next start of this node: a new ROS master would not know them
/// @throw as read_parameters()
void run_bridge(const KeptText& kept);

/// Runs `program` in a child process, and starts it again whenever it ends, since a reset of its node kills a bridge.
/// The respawn of roslaunch would also restart a bridge with wrong parameters, for ever.
///
/// It ends if this process is asked to end (SIGINT, SIGTERM, SIGHUP, which are passed on to the child), and if the
/// child ends with 2, because with wrong parameters another try would end the same way. If the process that started it
/// is gone, it ends together with its child: nobody else would end them after roslaunch was killed.
/// @pre this process has one thread
/// @return exit code of the last child
int respawned(const std::function<int()>& program);

}  // namespace limb_ring::bridge
