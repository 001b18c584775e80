// What hears of all nodes, and one of them does not answer.
#include "ros_bridge/ring_listener.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>

#include "client/fake_daemon.h"
#include "host/node_lock.h"
#include "ros/small_robot.h"
#include "ros_bridge/events_out.h"
#include "support/own_folder.h"

namespace limb_ring::bridge {
namespace {

/// A process that holds a node as its daemon does, and is stopped.
class StoppedHolder {
 public:
  explicit StoppedHolder(const config::NodeConfig& node) : pid_(::fork()) {
    if (pid_ == 0) {
      const host::NodeLock held(make_ring_directory("small"), "small", node.id, node.name);
      ::raise(SIGSTOP);
      ::_exit(0);
    }
    ::waitpid(pid_, nullptr, WUNTRACED);
  }
  ~StoppedHolder() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  StoppedHolder(const StoppedHolder&) = delete;
  StoppedHolder& operator=(const StoppedHolder&) = delete;

 private:
  pid_t pid_;
};

using Listening = test::OwnFolder;

TEST_F(Listening, AFrozenDaemonLetsNobodyWait) {
  const config::RingConfig ring = small_robot();
  const StoppedHolder holder(ring.nodes[0]);
  const test::FakeDaemon frozen("small", ring.nodes[0].name);
  test::FakeDaemon other("small", ring.nodes[1].name);
  ConnectOptions daemon;
  daemon.ring = "small";
  const RingListener listener(all_nodes(ring), daemon, "{}", [](const auto&, const Message&) {});
  other.accept();
  EXPECT_FALSE(frozen.is_tried()) << "the other one's turn came behind it";
}

}  // namespace
}  // namespace limb_ring::bridge
