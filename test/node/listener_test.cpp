#include "node/host_server.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "client/frame.h"
#include "limb_ring/ring_directory.h"
#include "support/runtime_folder.h"
#include "support/thrown.h"

namespace limb_ring::host {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ListenerTest : public testing::Test {
 protected:
  Listener listen() { return {io, directory, 3, "left_knee"}; }
  bool answers(const std::string& node) const {
    return client::UnixSocket::connect(directory + "/" + node + ".host").has_value();
  }

  test::RuntimeFolder folder;
  std::string directory = make_ring_directory("r");
  boost::asio::io_context io;
};

TEST_F(ListenerTest, AnswersByIdAndByName) {
  const Listener listener(io, directory, 3, "left_knee");
  EXPECT_TRUE(answers("3"));
  EXPECT_TRUE(answers("left_knee"));
}

TEST_F(ListenerTest, IsForItsOwnerOnly) {
  const Listener listener(io, directory, 3, "left_knee");
  struct stat status {};
  ASSERT_EQ(stat((directory + "/3.host").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
}

TEST_F(ListenerTest, LeavesNothingBehind) {
  { const Listener listener(io, directory, 3, "left_knee"); }
  EXPECT_TRUE(fs::is_empty(directory));
}

TEST_F(ListenerTest, ReplacesTheSocketOfADeadDaemon) {
  {
    const Listener dead(io, directory, 3, "left_knee");
    fs::rename(directory + "/3.host", directory + "/kept");
  }
  fs::rename(directory + "/kept", directory + "/3.host");
  fs::create_symlink("3.host", directory + "/left_knee.host");
  ASSERT_FALSE(answers("3"));
  const Listener listener(io, directory, 3, "left_knee");
  EXPECT_TRUE(answers("left_knee"));
}

TEST_F(ListenerTest, LeavesAFileAloneThatIsNoSocket) {
  std::ofstream(directory + "/3.host") << "mine";
  EXPECT_THAT(test::thrown<std::runtime_error>([&] { listen(); }), HasSubstr("is in the way"));
  EXPECT_TRUE(fs::is_regular_file(directory + "/3.host"));
}

TEST_F(ListenerTest, NeedsNoLinkForANameThatIsItsId) {
  const Listener listener(io, directory, 3, "3");
  EXPECT_TRUE(answers("3"));
  EXPECT_FALSE(fs::is_symlink(directory + "/3.host"));
}

TEST_F(ListenerTest, IsInPlaceOnlyWithItsName) {
  Listener listener(io, directory, 3, "left_knee");
  EXPECT_TRUE(listener.is_in_place());
  fs::remove(directory + "/left_knee.host");
  EXPECT_FALSE(listener.is_in_place());
  std::ofstream(directory + "/left_knee.host") << "mine";
  EXPECT_THAT(test::thrown<std::runtime_error>([&] { listener.listen_again(); }), HasSubstr("is in the way"));
  EXPECT_FALSE(listener.is_in_place()) << "nobody would try again";
  fs::remove(directory + "/left_knee.host");
  listener.listen_again();
  EXPECT_TRUE(listener.is_in_place());
  EXPECT_TRUE(answers("left_knee"));
}

TEST_F(ListenerTest, NamesThePathThatIsTooLong) {
  directory += "/" + std::string(100, 'd');
  EXPECT_THAT(test::thrown<std::invalid_argument>([&] { listen(); }), HasSubstr("107"));
}

}  // namespace
}  // namespace limb_ring::host
