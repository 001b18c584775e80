#include "io/output.h"

#include <gmock/gmock.h>

#include <functional>
#include <stdexcept>

#include "io/link_rig.h"
#include "io/unix_line.h"
#include "io/unix_listener.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;

/// Long silence: what is tested here is the socket's limit, not the heartbeat.
struct FullLine : testing::Test {
  LinkRig rig{2, Endpoint::Transport::unix_stream, Timing{milliseconds(10), milliseconds(20000), milliseconds(200)}};
  std::size_t sent = 0;

  void fill() {
    wire::SliceWriter one;
    put_whole(one, 524, 3);
    rig.node(1).frozen = true;
    while (rig.node(0).output->ready()) {
      rig.node(0).output->write(one.view());
      ++sent;
      ASSERT_LT(sent, 100000u);
    }
  }
  void SetUp() override {
    rig.start_all();
    ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
    fill();
  }
};

TEST_F(FullLine, IsNotReadyAndSaysWhenItIsAgain) {
  EXPECT_TRUE(rig.node(0).output->up());
  EXPECT_EQ(rig.node(0).output->counters().blocked, 1u);
  EXPECT_EQ(rig.node(0).said.ready, 0);
  rig.node(1).frozen = false;
  ASSERT_TRUE(rig.until([&] { return rig.node(0).said.ready == 1; }));
  EXPECT_TRUE(rig.node(0).output->ready());
  EXPECT_TRUE(rig.until([&] { return rig.node(1).heard.slices.size() == sent; }));
}

TEST_F(FullLine, StillTakesWritesUpToALimit) {
  wire::SliceWriter one;
  put_whole(one, 524, 3);
  for (int i = 0; i < 100; ++i, ++sent) rig.node(0).output->write(one.view());
  rig.node(1).frozen = false;
  ASSERT_TRUE(rig.until([&] { return rig.node(1).heard.slices.size() == sent; }));
  EXPECT_EQ(rig.node(1).input->counters().malformed, 0u);
}

TEST_F(FullLine, IsLostIfFarTooMuchIsWritten) {
  wire::SliceWriter one;
  put_whole(one, 524, 3);
  for (int i = 0; i < 3000; ++i) rig.node(0).output->write(one.view());
  EXPECT_THAT(rig.node(0).said.log, ElementsAre("up 1")) << "never from within a call";
  ASSERT_TRUE(rig.until([&] { return rig.node(0).said.log.size() > 1; }));
  EXPECT_GT(rig.node(0).output->counters().discarded, 0u);
}

TEST(Output, DiscardsAndCountsWhatIsWrittenWhileItIsDown) {
  LinkRig rig(2, Endpoint::Transport::unix_stream);
  rig.start_output(0);
  EXPECT_FALSE(rig.node(0).output->ready());
  wire::SliceWriter one;
  put_whole(one, 524, 3);
  rig.node(0).output->write(one.view());
  EXPECT_EQ(rig.node(0).output->counters().discarded, one.view().size);
}

TEST(Output, NeedsCandidatesWithRealAddresses) {
  LinkRig rig(1, Endpoint::Transport::udp);
  OutputSettings settings = rig.output_settings(0);
  settings.candidates[0].endpoint.address = "somewhere";
  EXPECT_THROW(Output(rig.node(0).io, settings, rig.node(0).said), std::runtime_error);
  settings.candidates.clear();
  EXPECT_THROW(Output(rig.node(0).io, settings, rig.node(0).said), std::invalid_argument);
}

TEST(Output, DoesNotGoBeyondALivingNodeWhoseInputAnotherOneHolds) {
  LinkRig rig(3, Endpoint::Transport::unix_stream);
  rig.start_all();
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  // Node 0 can no longer reach node 1, which lives: the line is cut, and no bypass is right.
  OutputSettings settings = rig.output_settings(0);
  settings.candidates[0].endpoint.path = rig.folder().file("cut");
  rig.node(0).output.reset();
  rig.node(0).output = std::make_unique<Output>(rig.node(0).io, settings, rig.node(0).said);
  ASSERT_TRUE(rig.until([&] { return rig.node(0).output->counters().refused > 5; }));
  EXPECT_FALSE(rig.node(0).output->up());
  EXPECT_TRUE(rig.linked(1, 2));
  EXPECT_TRUE(rig.linked(2, 0));
}

/// What node 0 says of a neighbour that answers its question with these bytes.
std::vector<std::string> said_of(const std::vector<std::uint8_t>& answer) {
  LinkRig rig(2, Endpoint::Transport::unix_stream);
  event_loop::UnixListener door(rig.node(1).io, rig.endpoint(1).path);
  std::vector<event_loop::UnixSocket> pending;
  std::function<void()> open = [&] {
    door.acceptor().async_accept([&](const boost::system::error_code& error, event_loop::UnixSocket socket) {
      if (error) return;
      send_now(socket.native_handle(), {answer.data(), answer.size()});
      pending.push_back(std::move(socket));
      open();
    });
  };
  open();
  rig.start_output(0);
  EXPECT_TRUE(rig.until([&] { return pending.size() > 3; })) << "asked again and again";
  return rig.node(0).said.refusals;
}

TEST(Output, SaysOnceThatItsNeighbourIsNotANode) {
  EXPECT_THAT(said_of(std::vector<std::uint8_t>(kLinkHeaderSize, 'x')), ElementsAre("1: peer is not a limb_ring node"));
}

TEST(Output, SaysOnceThatItsNeighbourSpeaksAnotherVersion) {
  LinkHeader refuse;
  refuse.version = 4;
  refuse.type = LinkHeaderType::refuse;
  refuse.refusal = Refusal::wrong_version;
  const auto bytes = encode(refuse);
  EXPECT_THAT(said_of({bytes.begin(), bytes.end()}),
              ElementsAre("1: protocol mismatch: peer speaks version 4, this is version 3; update this node"));
}

TEST(Output, MayBeClosedByItsHandler) {
  struct Closing : RecordingOutput {
    Output* output = nullptr;
    void on_output_up(std::uint8_t to) override {
      RecordingOutput::on_output_up(to);
      output->close();
    }
  } handler;
  LinkRig rig(2, Endpoint::Transport::unix_stream);
  rig.start_input(1);
  Output output(rig.node(0).io, rig.output_settings(0), handler);
  handler.output = &output;
  ASSERT_TRUE(rig.until([&] { return !handler.log.empty(); }));
  rig.run_for(milliseconds(50));
  EXPECT_THAT(handler.log, ElementsAre("up 1"));
}

}  // namespace
}  // namespace limb_ring::link
