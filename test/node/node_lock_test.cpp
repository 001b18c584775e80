#include "node/host_server.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>

#include "limb_ring/ring_directory.h"
#include "support/runtime_folder.h"
#include "support/thrown.h"

namespace limb_ring::host {
namespace {

using testing::HasSubstr;

class NodeLockTest : public testing::Test {
 protected:
  std::string refusal() {
    return test::thrown<std::runtime_error>([this] { NodeLock(directory, "r", 3, "left_knee"); });
  }

  test::RuntimeFolder folder;
  std::string directory = make_ring_directory("r");
};

TEST_F(NodeLockTest, SaysWhoHoldsTheNode) {
  const NodeLock held(directory, "r", 3, "left_knee");
  EXPECT_EQ(refusal(), "node 3 (left_knee) of ring r is held by pid " + std::to_string(getpid()) + " (host_test)");
}

TEST_F(NodeLockTest, SaysHowToStartTheHolderAgain) {
  const NodeLock held(directory, "r", 3, "left_knee");
  std::ifstream file(directory + "/3.lock");
  std::string pid, program, working_folder;
  std::getline(file, pid);
  std::getline(file, program, '\0');
  std::getline(file, working_folder, '\0');
  EXPECT_EQ(pid, std::to_string(getpid()));
  EXPECT_EQ(std::filesystem::path(program).filename(), "host_test");
  EXPECT_EQ(working_folder, std::filesystem::current_path());
}

TEST_F(NodeLockTest, IsPerNode) {
  const NodeLock held(directory, "r", 3, "left_knee");
  EXPECT_NO_THROW(NodeLock(directory, "r", 4, "right_knee"));
}

TEST_F(NodeLockTest, IsGivenUpInTheEnd) {
  { const NodeLock held(directory, "r", 3, "left_knee"); }
  EXPECT_EQ(refusal(), "");
}

TEST_F(NodeLockTest, IsTakenFromAHolderThatTakesAMomentToEnd) {
  auto held = std::make_unique<NodeLock>(directory, "r", 3, "left_knee");
  auto second = std::async(std::launch::async, [this] { return refusal(); });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // what it takes to end
  held.reset();
  EXPECT_EQ(second.get(), "");
}

TEST_F(NodeLockTest, IsGivenUpByAProcessThatIsKilled) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t holder = fork();
  if (holder == 0) {
    const NodeLock held(directory, "r", 3, "left_knee");
    if (write(ready[1], "x", 1) != 1) _exit(1);
    for (;;) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THAT(refusal(), HasSubstr("pid " + std::to_string(holder)));
  kill(holder, SIGKILL);
  waitpid(holder, nullptr, 0);
  EXPECT_EQ(refusal(), "");
  close(ready[0]);
  close(ready[1]);
}

TEST_F(NodeLockTest, IsNotInheritedByPrograms) {
  const NodeLock held(directory, "r", 3, "left_knee");
  int inherited = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code error;
    const auto target = std::filesystem::read_symlink(entry.path(), error);
    if (error || target.filename() != "3.lock") continue;
    std::ifstream info("/proc/self/fdinfo/" + entry.path().filename().string());
    std::string word;
    while (info >> word && word != "flags:") {
    }
    info >> word;
    inherited += (std::stol(word, nullptr, 8) & 02000000) == 0;  // O_CLOEXEC
  }
  EXPECT_EQ(inherited, 0);
}

TEST_F(NodeLockTest, NamesTheFileItCannotOpen) {
  directory += "/none";
  EXPECT_THAT(refusal(), HasSubstr(directory + "/3.lock"));
}

}  // namespace
}  // namespace limb_ring::host
