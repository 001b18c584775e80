// daemon/io: temporary folders, and what is left of them where their process was killed.
#include "io/regular_file.h"

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "io/unique_fd.h"
#include "support/temporary_folder.h"

namespace limb_ring::process {
namespace {

namespace fs = std::filesystem;

/// Temporary folders are made below one of the test's own.
class TemporaryFolders : public testing::Test {
 protected:
  TemporaryFolders() { ::setenv("TMPDIR", below_.path().c_str(), 1); }
  ~TemporaryFolders() override { ::unsetenv("TMPDIR"); }

  test::TemporaryFolder below_;
};

/// Names of what was removed from a watched folder, in order.
std::vector<std::string> removed(int watch) {
  alignas(inotify_event) char events[4096];
  const ssize_t size = ::read(watch, events, sizeof events);
  std::vector<std::string> names;
  for (ssize_t at = 0; at < size;) {
    const auto* event = reinterpret_cast<const inotify_event*>(events + at);
    if (event->len > 0) names.emplace_back(event->name);
    at += static_cast<ssize_t>(sizeof *event + event->len);
  }
  return names;
}

// Without its lock nobody could tell what is left of it from a folder that is just being made.
TEST_F(TemporaryFolders, TheLockIsRemovedBehindAllElse) {
  const UniqueFd watch(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC));
  {
    const TemporaryFolder folder("test");
    for (const char* name : {"a", "z", "0.lock"}) std::ofstream(folder.file(name)) << name;
    ASSERT_GE(::inotify_add_watch(watch.get(), folder.path().c_str(), IN_DELETE), 0);
  }
  const std::vector<std::string> names = removed(watch.get());
  ASSERT_EQ(names.size(), 4u);
  EXPECT_EQ(names.back(), "owner.lock");
  EXPECT_TRUE(fs::is_empty(below_.path()));
}

TEST_F(TemporaryFolders, AnEmptyOneThatWasLeftBehindIsRemovedByTheNext) {
  fs::create_directory(below_.file("limb_ring_test_killed"));
  fs::create_directory(below_.file("limb_ring_other_killed"));
  const TemporaryFolder folder("test");
  EXPECT_FALSE(fs::exists(below_.file("limb_ring_test_killed")));
  EXPECT_TRUE(fs::exists(below_.file("limb_ring_other_killed"))) << "is of another purpose";
  EXPECT_TRUE(fs::exists(folder.path()));
}

TEST_F(TemporaryFolders, OneThatSomebodyHoldsIsLeftAlone) {
  const TemporaryFolder first("test"), second("test");
  EXPECT_TRUE(fs::exists(first.path()));
  EXPECT_NE(first.path(), second.path());
}

}  // namespace
}  // namespace limb_ring::process
