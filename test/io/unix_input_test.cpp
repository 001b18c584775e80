#include <gmock/gmock.h>

#include <fstream>
#include <stdexcept>

#include "io/link_header.h"
#include "io/link_rig.h"
#include "io/unix_line.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Node 1's input, with this test as node 0.
struct UnixInputFromHand : testing::Test {
  LinkRig rig{3, Endpoint::Transport::unix_stream};
  process::UniqueFd line;
  RecordingInput& heard = rig.node(1).heard;

  void SetUp() override {
    rig.start_input(1);
    line = greet(0);
    ASSERT_TRUE(rig.until([&] { return rig.node(1).input->from() == 0; }));
  }
  process::UniqueFd greet(std::uint8_t sender) {
    process::UniqueFd socket = connect_unix(rig.endpoint(1).path);
    LinkHeader header;
    header.type = LinkHeaderType::connect;
    header.ring = LinkRig::kRing;
    header.sender = sender;
    const auto bytes = encode_connect(header, {});
    send_now(socket.get(), {bytes.data(), bytes.size()});
    return socket;
  }
  const InputCounters& counters() { return rig.node(1).input->counters(); }
};

TEST_F(UnixInputFromHand, PutsASliceTogetherThatComesByteByByte) {
  wire::SliceWriter writer;
  put_whole(writer, 40, 5);
  const wire::ByteView framed = writer.view();
  for (std::size_t i = 0; i < framed.size; ++i) {
    send_now(line.get(), framed.from(i).first(1));
    ASSERT_TRUE(rig.until([&] { return counters().bytes == i + 1; }));
  }
  EXPECT_THAT(heard.slices, ElementsAre(std::vector<std::uint8_t>(40, 5)));
}

TEST_F(UnixInputFromHand, IsLostAtOnceWhenTheOtherEndCloses) {
  line.reset();
  ASSERT_TRUE(rig.until([&] { return !rig.node(1).input->up(); }));
  EXPECT_THAT(heard.log, ElementsAre("up 0", HasSubstr("closed")));
}

TEST_F(UnixInputFromHand, HandsOnWhatCameBeforeTheEnd) {
  wire::SliceWriter writer;
  put_whole(writer, 524, 5);
  send_now(line.get(), writer.view());
  line.reset();
  ASSERT_TRUE(rig.until([&] { return !rig.node(1).input->up(); }));
  EXPECT_THAT(heard.log, ElementsAre("up 0", "slice", "batch end", HasSubstr("closed")));
}

TEST_F(UnixInputFromHand, IsLostWhenNothingComesForTooLong) {
  ASSERT_TRUE(rig.until([&] { return !rig.node(1).input->up(); }));
  EXPECT_THAT(heard.log, ElementsAre("up 0", "lost: silent"));
  EXPECT_EQ(counters().silences, 1u);
}

TEST_F(UnixInputFromHand, IsClosedOnAnInvalidSlice) {
  const std::vector<std::uint8_t> garbage(50, 0xFF);
  send_now(line.get(), {garbage.data(), garbage.size()});
  ASSERT_TRUE(rig.until([&] { return !rig.node(1).input->up(); }));
  EXPECT_EQ(counters().malformed, 1u);
  EXPECT_THAT(heard.log, ElementsAre("up 0", HasSubstr("not a slice")));
}

TEST_F(UnixInputFromHand, TellsTheReplacedOneWhy) {
  process::UniqueFd again = greet(0);
  ASSERT_TRUE(rig.until([&] { return counters().replaced == 1; }));
  EXPECT_THAT(heard.log, ElementsAre("up 0", "lost: replaced by node 0", "up 0"));
  std::optional<LinkHeader> last;
  ASSERT_TRUE(rig.until([&] {
    std::array<std::uint8_t, kLinkHeaderSize> bytes;
    const auto got = receive_now(line.get(), bytes.data(), bytes.size());
    if (got > 0) last = parse_header({bytes.data(), static_cast<std::size_t>(got)});
    return got == 0;
  }));
  ASSERT_TRUE(last);
  EXPECT_EQ(last->refusal, Refusal::replaced);
}

TEST_F(UnixInputFromHand, MayBeClosedByItsHandlerInTheMiddleOfABatch) {
  struct Closing : RecordingInput {
    Input* input = nullptr;
    void on_slice(const wire::Slice& slice) override {
      RecordingInput::on_slice(slice);
      input->close();
    }
  } handler;
  rig.node(1).input.reset();
  Input input(rig.node(1).io, rig.input_settings(1), handler);
  handler.input = &input;
  line = greet(0);
  wire::SliceWriter writer;
  put_whole(writer, 20, 1);
  put_whole(writer, 20, 2);
  send_now(line.get(), writer.view());
  ASSERT_TRUE(rig.until([&] { return !handler.slices.empty(); }));
  rig.run_for(milliseconds(30));
  EXPECT_THAT(handler.log, ElementsAre("up 0", "slice"));
}

std::string complaint_about(const Endpoint& endpoint) {
  LinkRig rig(1, Endpoint::Transport::unix_stream);
  InputSettings settings = rig.input_settings(0);
  settings.endpoint = endpoint;
  try {
    Input input(rig.node(0).io, settings, rig.node(0).heard);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(UnixInputPath, ThatIsTooLongIsRefused) {
  EXPECT_THAT(complaint_about(Endpoint::unix_stream("/" + std::string(120, 'x'))), HasSubstr("1 to 107 bytes"));
}

TEST(UnixInputPath, ThatHoldsAnOrdinaryFileIsLeftAlone) {
  TemporaryFolder folder;
  const std::string path = folder.file("notes");
  std::ofstream(path) << "dear diary";
  EXPECT_THAT(complaint_about(Endpoint::unix_stream(path)), HasSubstr("not a socket"));
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST(UnixInputPath, InAFolderThatIsNotThereIsNamed) {
  EXPECT_THAT(complaint_about(Endpoint::unix_stream("/nowhere/at/all")), HasSubstr("/nowhere/at/all"));
}

}  // namespace
}  // namespace limb_ring::link
