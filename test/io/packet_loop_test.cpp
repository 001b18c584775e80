#include "io/packet_loop.h"

#include <gtest/gtest.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>

#include <boost/asio/steady_timer.hpp>
#include <string>

#include "io/on_one_core.h"
#include "io/unique_fd.h"

namespace limb_ring::event_loop {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

enum class How { own_run, own_run_with_spin, asios_run };

void run_loop(boost::asio::io_context& io, How how) {
  if (how == How::asios_run)
    io.run();
  else
    PacketLoop::of(io).run(how == How::own_run_with_spin ? milliseconds(1) : milliseconds(0));
}

struct Loop : testing::TestWithParam<How> {
  boost::asio::io_context io;
  process::UniqueFd fd{::eventfd(0, EFD_NONBLOCK)};
  boost::asio::steady_timer guard{io, std::chrono::seconds(30)};
  std::string log;

  void run() {
    guard.async_wait([this](const boost::system::error_code& error) {
      if (!error) io.stop();
    });
    run_loop(io, GetParam());
  }
  void signal() { ::eventfd_write(fd.get(), 1); }
};
INSTANTIATE_TEST_SUITE_P(With, Loop, testing::Values(How::own_run, How::own_run_with_spin, How::asios_run),
                         [](const auto& with) {
                           return with.param == How::own_run             ? "ItsOwnRun"
                                  : with.param == How::own_run_with_spin ? "ItsOwnRunWithSpin"
                                                                         : "AsiosRun";
                         });

TEST_P(Loop, CallsOncePerSignal) {
  int calls = 0;
  Watch watch(io, fd.get(), EPOLLIN, [&](std::uint32_t events) {
    EXPECT_TRUE(events & EPOLLIN);
    if (++calls == 1000) return io.stop();
    signal();
  });
  signal();
  run();
  EXPECT_EQ(calls, 1000);
}

TEST_P(Loop, AsiosTimersRunWhilePacketsPass) {
  boost::asio::steady_timer timer(io, milliseconds(20));
  timer.async_wait([&](const boost::system::error_code&) { io.stop(); });
  int calls = 0;
  Watch watch(io, fd.get(), EPOLLIN, [&](std::uint32_t) {
    ++calls;
    signal();
  });
  signal();
  run();
  EXPECT_GT(calls, 1);
}

TEST_P(Loop, OthersGetTheirTurnsWhileOneAsksToBeCalledInEachTurn) {
  process::UniqueFd other(::eventfd(0, EFD_NONBLOCK));
  boost::asio::steady_timer timer(io, milliseconds(1));
  Watch busy;
  busy = Watch(io, fd.get(), EPOLLIN, [&](std::uint32_t) { busy.call_again(); });
  Watch second(io, other.get(), EPOLLIN, [&](std::uint32_t) { io.stop(); });
  timer.async_wait([&](const boost::system::error_code&) { ::eventfd_write(other.get(), 1); });
  signal();
  run();
}

TEST_P(Loop, WhatATurnLeadsToIsCalledAtItsEndInOrder) {
  process::UniqueFd other(::eventfd(0, EFD_NONBLOCK));
  PacketLoop& loop = PacketLoop::of(io);
  const auto reads = [&](const char* name) {
    return [this, &loop, name](std::uint32_t) {
      log += name;
      loop.at_turn_end([this, &loop, name] {
        log += std::string("end of ") + name;
        if (name == std::string("b ")) loop.at_turn_end([this] { io.stop(); });
      });
    };
  };
  Watch first(io, fd.get(), EPOLLIN, reads("a ")), second(io, other.get(), EPOLLIN, reads("b "));
  signal();
  ::eventfd_write(other.get(), 1);
  run();
  EXPECT_EQ(log, "a b end of a end of b ");
}

TEST_P(Loop, WhatIsAskedForOutsideOfATurnIsDoneSoon) {
  boost::asio::steady_timer timer(io, milliseconds(1));
  timer.async_wait([&](const boost::system::error_code&) {
    PacketLoop::of(io).at_turn_end([&] {
      log = "done";
      io.stop();
    });
  });
  run();
  EXPECT_EQ(log, "done");
}

TEST_P(Loop, CallsAgainWithoutASignal) {
  Watch watch;
  int calls = 0;
  watch = Watch(io, fd.get(), EPOLLIN, [&](std::uint32_t events) {
    EXPECT_EQ(events == 0, calls > 0);
    if (++calls == 3) return io.stop();
    watch.call_again();
  });
  signal();
  run();
  EXPECT_EQ(calls, 3);
}

TEST_P(Loop, ALevelCallsInEachTurnUntilNothingIsLeft) {
  process::UniqueFd three(::eventfd(3, EFD_NONBLOCK | EFD_SEMAPHORE));
  int calls = 0;
  Watch watch;
  watch = Watch(
      io, three.get(), EPOLLIN,
      [&](std::uint32_t) {
        eventfd_t one;
        EXPECT_EQ(::eventfd_read(three.get(), &one), 0);
        if (++calls == 3) PacketLoop::of(io).at_turn_end([this] { io.stop(); });
      },
      Watch::Trigger::level);
  run();
  EXPECT_EQ(calls, 3);
}

using LoopOnOneCore = OnOneCore;

TEST_F(LoopOnOneCore, LooksFirstWherePacketsHaveComeAndStillSeesWhatComesElsewhere) {
  boost::asio::io_context io;
  process::UniqueFd fd{::eventfd(1, EFD_NONBLOCK)};
  boost::asio::steady_timer guard(io, std::chrono::seconds(30));
  guard.async_wait([&io](const boost::system::error_code&) { io.stop(); });
  process::UniqueFd other{::eventfd(0, EFD_NONBLOCK)};
  Watch elsewhere(io, other.get(), EPOLLIN, [&io](std::uint32_t) { io.stop(); });
  int looks = 0, found = 0;
  Watch packets;
  packets = Watch(io, fd.get(), EPOLLIN, [&](std::uint32_t events) {
    looks += events == 0;
    eventfd_t count;
    if (::eventfd_read(fd.get(), &count) != 0) return;
    packets.found_packets();
    ::eventfd_write(fd.get(), 1);
    if (events == 0 && ++found == 3) ::eventfd_write(other.get(), 1);
  });
  PacketLoop::of(io).run();
  EXPECT_GE(found, 3);
  EXPECT_LE(found, 4);
  EXPECT_EQ(looks, found);
}

TEST_P(Loop, NoCallAfterStopEvenIfBothWereReady) {
  process::UniqueFd other(::eventfd(0, EFD_NONBLOCK));
  Watch first, second;
  const auto stops = [&](Watch& another) {
    return [this, &another](std::uint32_t) {
      log += "x";
      another.stop();
      PacketLoop::of(io).at_turn_end([this] { io.stop(); });
    };
  };
  first = Watch(io, fd.get(), EPOLLIN, stops(second));
  second = Watch(io, other.get(), EPOLLIN, stops(first));
  signal();
  ::eventfd_write(other.get(), 1);
  run();
  EXPECT_EQ(log, "x");
}

TEST_P(Loop, AWatchMayBeEndedFromWithinItsOwnCall) {
  auto watch = std::make_unique<Watch>();
  *watch = Watch(io, fd.get(), EPOLLIN, [&](std::uint32_t) {
    watch.reset();
    log += "still here";
    io.stop();
  });
  signal();
  run();
  EXPECT_EQ(log, "still here");
}

TEST_P(Loop, EndsByItselfIfNothingIsWatched) {
  guard.cancel();
  Watch watch(io, fd.get(), EPOLLIN, [&](std::uint32_t) { watch.stop(); });
  signal();
  run_loop(io, GetParam());
  EXPECT_TRUE(io.stopped());
}

TEST_P(Loop, ADescriptorThatCannotBeWaitedForIsAnError) {
  process::UniqueFd folder(::open("/", O_RDONLY));
  EXPECT_THROW(Watch(io, folder.get(), EPOLLIN, [](std::uint32_t) {}), std::system_error);
}

TEST_P(Loop, ATimerCallsOnceNotBeforeItsTimeAndNotWhenCancelled) {
  const auto start = steady_clock::now();
  PacketTimer cancelled(io, [] { FAIL(); });
  int calls = 0;
  PacketTimer last(io, [&] { io.stop(); });
  PacketTimer timer(io, [&] {
    EXPECT_GE(steady_clock::now(), start + milliseconds(5));
    ++calls;
    last.expires_at(steady_clock::now() + milliseconds(20));
  });
  cancelled.expires_at(start + milliseconds(10));
  cancelled.cancel();
  timer.expires_at(start + milliseconds(50));
  timer.expires_at(start + milliseconds(5));
  run();
  EXPECT_EQ(calls, 1);
}

TEST_P(Loop, ATimerInThePastCallsAtOnce) {
  PacketTimer timer(io, [&] { io.stop(); });
  timer.expires_at(steady_clock::time_point{});
  run();
  SUCCEED();
}

}  // namespace
}  // namespace limb_ring::event_loop
