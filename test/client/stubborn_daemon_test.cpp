// Daemons that end, say nonsense, or do not read.
#include <gmock/gmock.h>

#include <future>
#include <mutex>

#include "client/fake_daemon.h"
#include "client/frame.h"
#include "limb_ring/host_port.h"
#include "support/runtime_folder.h"
#include "support/thrown.h"

namespace limb_ring {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

constexpr seconds kGuard{30};

class StubbornDaemon : public testing::Test {
 protected:
  HostPort connect(Role role = Role::tool, milliseconds alive_period = milliseconds{0}) {
    ConnectOptions options;
    options.ring = "r";
    options.node = "3";
    options.role = role;
    options.alive_period = alive_period;
    auto port = std::async([&] { return HostPort::connect(options); });
    daemon.welcome();
    return port.get();
  }

  test::RuntimeFolder folder;
  test::FakeDaemon daemon;
};

template <typename Kind>
Kind next(HostPort& port) {
  return std::get<Kind>(port.receive(kGuard).value());
}

TEST_F(StubbornDaemon, EndingCancelsOutstandingCallsBeforeItIsReported) {
  HostPort port = connect();
  const std::uint32_t sent = port.send(4, {1});
  const std::uint32_t interrupted = port.interrupt(4, 0);
  const std::uint32_t asked = port.request("{}");
  daemon.hang_up();
  const auto first = next<Result>(port);
  EXPECT_EQ(first.token, sent);
  EXPECT_EQ(first.outcome, Outcome::cancelled);
  EXPECT_EQ(next<Result>(port).token, interrupted);
  EXPECT_EQ(next<Reply>(port).token, asked);
  EXPECT_THAT(next<Disconnected>(port).reason, HasSubstr("closed the connection"));
  EXPECT_FALSE(port.connected());
  EXPECT_FALSE(port.receive(kGuard));
}

TEST_F(StubbornDaemon, BeingGoneCancelsLaterCallsToo) {
  HostPort port = connect();
  daemon.hang_up();
  next<Disconnected>(port);
  EXPECT_EQ(port.wait(port.send(4, {1}), kGuard).outcome, Outcome::cancelled);
  EXPECT_THAT(test::thrown<HostPortError>([&] { port.ask("{}", kGuard); }), HasSubstr("closed the connection"));
}

/// What one read has brought is taken without a system call for each; an interrupt that comes meanwhile waits for
/// 16 of them at most.
TEST_F(StubbornDaemon, AnInterruptOvertakesMostOfWhatHasArrived) {
  HostPort port = connect();
  for (int i = 0; i < 100; ++i) daemon.say(Observed{"{}"});
  next<Observed>(port);
  daemon.say(Interrupt{});
  int before = 0;
  while (std::holds_alternative<Observed>(port.receive(kGuard).value())) ++before;
  EXPECT_EQ(before, 16);
}

TEST_F(StubbornDaemon, EndingDuringARequestEndsTheRequest) {
  HostPort port = connect();
  auto answer = std::async([&] { return port.ask("{}", kGuard); });
  daemon.hear(1);
  daemon.hang_up();
  EXPECT_THROW(answer.get(), HostPortError);
}

TEST_F(StubbornDaemon, IsWaitedForIfItsQueueOfClientsIsFullEvenWithoutATimeOut) {
  std::vector<client::UnixSocket> others;
  while (auto other = client::UnixSocket::connect(socket_path(ring_directory("r"), "3", "host")))
    others.push_back(std::move(*other));
  ASSERT_EQ(errno, EAGAIN);
  ConnectOptions options;
  options.ring = "r";
  options.node = "3";
  options.timeout = milliseconds{0};
  std::promise<void> is_full;
  std::once_flag once;
  options.meanwhile = [&] { std::call_once(once, [&] { is_full.set_value(); }); };
  auto port = std::async(std::launch::async, [&] { return HostPort::connect(options); });
  ASSERT_EQ(is_full.get_future().wait_for(kGuard), std::future_status::ready);
  for (std::size_t i = 0; i < others.size(); ++i) {
    daemon.accept();
    daemon.hang_up();
  }
  daemon.welcome();
  EXPECT_EQ(port.get().id(), 3);
}

TEST_F(StubbornDaemon, GivesItsReasonForEndingAConnection) {
  HostPort port = connect();
  daemon.say(client::Refused{"reset"});
  daemon.hang_up();
  EXPECT_EQ(next<Disconnected>(port).reason, "reset");
}

TEST_F(StubbornDaemon, SendingGarbageIsDisconnected) {
  HostPort port = connect();
  daemon.say_bytes({0, 0, 0, 1, 0x55});
  EXPECT_THAT(next<Disconnected>(port).reason, HasSubstr("not a message"));
}

TEST_F(StubbornDaemon, ClaimingAHugeMessageIsDisconnected) {
  HostPort port = connect();
  daemon.say_bytes({0xFF, 0xFF, 0xFF, 0xFF, 0x85});
  EXPECT_THAT(next<Disconnected>(port).reason, HasSubstr("not a message"));
}

TEST_F(StubbornDaemon, AnsweringACallTwiceIsHeardOnce) {
  HostPort port = connect();
  const std::uint32_t token = port.send(4, {1});
  daemon.say(Result{token, Outcome::delivered, {}, 1, ""});
  daemon.say(Result{token, Outcome::lost, {}, 1, ""});
  daemon.say(Result{token + 1, Outcome::lost, {}, 1, ""});
  daemon.say(Observed{"last"});
  EXPECT_EQ(next<Result>(port).outcome, Outcome::delivered);
  EXPECT_EQ(next<Observed>(port).json, "last");
}

TEST_F(StubbornDaemon, SayingAMessageByteByByteIsUnderstood) {
  HostPort port = connect();
  client::Bytes bytes;
  client::append(bytes, Observed{"in pieces"});
  for (const std::uint8_t byte : bytes) {
    EXPECT_FALSE(port.receive(milliseconds{0}));
    daemon.say_bytes({byte});
  }
  EXPECT_EQ(next<Observed>(port).json, "in pieces");
}

TEST_F(StubbornDaemon, IsWaitedForUpToTheLargestNumberOfMilliseconds) {
  HostPort port = connect();
  auto received = std::async(std::launch::async, [&] { return port.receive(milliseconds::max()); });
  EXPECT_EQ(received.wait_for(milliseconds{20}), std::future_status::timeout) << "it did not wait";
  daemon.say(Observed{"at last"});
  EXPECT_TRUE(received.get());
}

TEST_F(StubbornDaemon, NotReadingEndsTheConnectionInsteadOfHangingTheClient) {
  HostPort port = connect();
  const std::vector<std::uint8_t> data(512);
  while (port.connected()) port.send(4, data);
  bool told = false;
  while (const auto message = port.receive(milliseconds{0})) {
    const auto* end = std::get_if<Disconnected>(&*message);
    if (end != nullptr) told = end->reason.find("has not read for 5 s") != std::string::npos;
  }
  EXPECT_TRUE(told);
}

TEST_F(StubbornDaemon, NotAnsweringInTimeIsReported) {
  HostPort port = connect();
  const std::uint32_t token = port.send(4, {1});
  EXPECT_THAT(test::thrown<HostPortError>([&] { port.wait(token, milliseconds{1}); }),
              HasSubstr("no result within 1 ms"));
  EXPECT_THAT(test::thrown<HostPortError>([&] { port.wait(token + 1, milliseconds{1}); }),
              HasSubstr("no result is outstanding"));
  EXPECT_THAT(test::thrown<HostPortError>([&] { port.ask("{}", milliseconds{1}); }),
              HasSubstr("did not answer within 1 ms"));
}

// An end that was received already does not come again, however long one waits.
TEST_F(StubbornDaemon, IsNotWaitedForIfNothingIsOutstanding) {
  HostPort port = connect();
  const std::uint32_t sent = port.send(4, std::vector<std::uint8_t>(100000));  // ends here: rejected
  EXPECT_EQ(next<Result>(port).token, sent);
  const auto waits = [&](auto wait) {
    auto said = std::async(std::launch::async, [&] { return test::thrown<HostPortError>(wait); });
    EXPECT_EQ(said.wait_for(kGuard), std::future_status::ready) << "it waits";
    if (said.wait_for(seconds{0}) != std::future_status::ready) daemon.hang_up();
    return said.get();
  };
  EXPECT_THAT(waits([&] { port.wait(sent, std::chrono::hours{1}); }), HasSubstr("no result is outstanding"));
  EXPECT_THAT(waits([&] { port.reply(sent, std::chrono::hours{1}); }), HasSubstr("no reply is outstanding"));
  const std::uint32_t asked = port.request("{}"), under_way = port.send(4, {1});  // neither ends here
  EXPECT_THAT(waits([&] { port.wait(asked, std::chrono::hours{1}); }), HasSubstr("no result is outstanding"));
  EXPECT_THAT(waits([&] { port.reply(under_way, std::chrono::hours{1}); }), HasSubstr("no reply is outstanding"));
}

TEST_F(StubbornDaemon, IsNotSentMoreThanAFrameHolds) {
  HostPort port = connect();
  const std::vector<std::uint8_t> large(100000);
  const Result result = port.wait(port.send(4, large), kGuard);
  EXPECT_EQ(result.outcome, Outcome::rejected);
  EXPECT_EQ(result.why, Reason::bad_size);
  EXPECT_EQ(result.reason, "size 100000: a packet carries 1 to 512 bytes");
  EXPECT_THROW(port.ask(std::string(100000, 'x'), kGuard), HostPortError);
  EXPECT_THROW(port.observe(std::string(100000, 'x')), HostPortError);
}

// What is wrong, its door says: there is one place that judges and one set of words.
TEST_F(StubbornDaemon, IsAskedWhetherArgumentsAreRight) {
  HostPort port = connect();
  const std::ptrdiff_t greeting = 5 + 16 + 2 + 1;
  const std::ptrdiff_t send = 5 + 4 + 3, interrupt = 5 + 4 + 3, pull = 5 + 4 + 1;
  port.send(4, nullptr, 0);
  port.send(4, {1}, 4);
  port.interrupt(4, 8);
  port.pull(8);
  EXPECT_EQ(daemon.hear(greeting + send + send + 1 + interrupt + pull).size(), 71u);
  EXPECT_FALSE(port.receive(milliseconds{0}));
}

TEST_F(StubbornDaemon, HearsFromACpuThatOnlyReceives) {
  HostPort port = connect(Role::cpu, milliseconds{4});
  const std::ptrdiff_t greeting_and_credit = (5 + 16 + 2 + 1) + (5 + 2);
  auto heard = std::async([&] { return daemon.hear(greeting_and_credit + 5); });
  while (heard.wait_for(seconds{0}) != std::future_status::ready) port.receive(milliseconds{1});
  const client::Bytes bytes = heard.get();
  const auto third = bytes.begin() + greeting_and_credit;
  EXPECT_THAT(client::Bytes(third, third + 5), testing::ElementsAre(0, 0, 0, 1, 7));  // Alive
}

}  // namespace
}  // namespace limb_ring
