// A line through shared memory, with this test as the node at its other end: one that writes what it likes.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <random>

#include "io/link_rig.h"
#include "io/memory_line.h"
#include "io/unix_line.h"
#include "io/unix_listener.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A pipe, as the sending end of a line makes it.
struct WakePipe {
  process::UniqueFd reading, writing;
  WakePipe() {
    std::array<int, 2> ends;
    EXPECT_EQ(::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
    reading.reset(ends[0]);
    writing.reset(ends[1]);
  }
  void wake() { EXPECT_EQ(::write(writing.get(), "", 1), 1); }
};

/// From now on whoever has this open file waits in it.
void make_it_wait(const process::UniqueFd& fd) {
  ASSERT_EQ(::fcntl(fd.get(), F_SETFL, ::fcntl(fd.get(), F_GETFL) & ~O_NONBLOCK), 0);
}

/// Node 1's input, with this test as node 0.
struct MemoryInputFromHand : testing::Test {
  LinkRig rig{3, Endpoint::Transport::shm};
  std::optional<QueueMemory> memory = QueueMemory::make(QueueMemory::kSmallest);
  QueueWriter queue{*memory};
  WakePipe pipe;
  process::UniqueFd line;
  RecordingInput& heard = rig.node(1).heard;

  void SetUp() override { rig.start_input(1); }

  void greet(const std::vector<int>& descriptors) {
    line = connect_unix(rig.endpoint(1).path);
    LinkHeader header;
    header.type = LinkHeaderType::connect_memory;
    header.ring = LinkRig::kRing;
    const auto bytes = encode_connect(header, {});
    if (descriptors.empty())
      send_now(line.get(), {bytes.data(), bytes.size()});
    else
      send_now(line.get(), {bytes.data(), bytes.size()}, descriptors);
  }
  void connect() {
    greet({memory->fd(), pipe.reading.get()});
    ASSERT_TRUE(rig.until([&] { return rig.node(1).input->from() == 0; }));
  }
  void put(const wire::SliceWriter& slices) {
    ASSERT_EQ(queue.put(slices.view()), static_cast<std::ptrdiff_t>(slices.view().size));
    if (queue.must_wake()) pipe.wake();
  }
  std::optional<LinkHeader> answer() {
    std::array<std::uint8_t, kLinkHeaderSize> bytes;
    std::optional<LinkHeader> header;
    rig.until([&] {
      const auto got = receive_now(line.get(), bytes.data(), bytes.size());
      if (got == static_cast<ssize_t>(bytes.size())) header = parse_header({bytes.data(), bytes.size()});
      return got >= 0;
    });
    return header;
  }
  bool lost() { return !rig.node(1).input->up(); }
  const InputCounters& counters() { return rig.node(1).input->counters(); }
};

TEST_F(MemoryInputFromHand, TakesSlicesOutOfTheQueue) {
  connect();
  wire::SliceWriter slices;
  put_whole(slices, 524, 5);
  put_whole(slices, 20, 6);
  put(slices);
  ASSERT_TRUE(rig.until([&] { return heard.slices.size() == 2; }));
  EXPECT_THAT(heard.log, ElementsAre("up 0", "slice", "slice", "batch end"));
}

TEST_F(MemoryInputFromHand, HandsOnWhatCameBeforeTheEnd) {
  connect();
  wire::SliceWriter slices;
  put_whole(slices, 524, 5);
  put(slices);
  line.reset();
  ASSERT_TRUE(rig.until([&] { return lost(); }));
  EXPECT_THAT(heard.log, ElementsAre("up 0", "slice", "batch end", HasSubstr("closed")));
}

TEST_F(MemoryInputFromHand, ABeatKeepsItAndSilenceEndsIt) {
  connect();
  ASSERT_TRUE(rig.until([&] {
    queue.beat();
    return counters().beats > 20;
  }));
  EXPECT_FALSE(lost());
  ASSERT_TRUE(rig.until([&] { return lost(); }));
  EXPECT_THAT(heard.log.back(), "lost: silent");
}

TEST_F(MemoryInputFromHand, TellsOfRoomIfTheWriterWaits) {
  connect();
  EXPECT_EQ(answer()->type, LinkHeaderType::accept);
  wire::SliceWriter slices;
  for (int i = 0; i < 7; ++i) put_whole(slices, 524, 5);
  put(slices);
  queue.wait_for_room();
  EXPECT_EQ(answer()->type, LinkHeaderType::alive);
}

TEST_F(MemoryInputFromHand, RefusesAnOfferWithoutMemory) {
  greet({});
  EXPECT_EQ(answer()->refusal, Refusal::invalid_memory);
}

TEST_F(MemoryInputFromHand, EndsWithDescriptorsInEachPartOfAHandshake) {
  line = connect_unix(rig.endpoint(1).path);
  LinkHeader header;
  header.type = LinkHeaderType::connect_memory;
  header.ring = LinkRig::kRing;
  const auto bytes = encode_connect(header, {});
  for (std::size_t sent = 0; sent < 3; ++sent)  // it could be as many as it has bytes
    send_now(line.get(), {bytes.data() + sent, 1}, {memory->fd(), pipe.reading.get()});
  ASSERT_TRUE(rig.until([&] { return counters().unknown_peers == 1; }));
  EXPECT_THAT(rig.node(1).input->last_unknown_peer(), HasSubstr("is not a limb_ring node"));
}

TEST_F(MemoryInputFromHand, RefusesMemoryThatIsNotSealed) {
  process::UniqueFd file(::open("/dev/zero", O_RDWR));
  greet({file.get(), pipe.reading.get()});
  EXPECT_EQ(answer()->refusal, Refusal::invalid_memory);
  EXPECT_THAT(rig.node(1).input->last_unknown_peer(), HasSubstr("shared memory"));
}

TEST_F(MemoryInputFromHand, RefusesAtOnceWhatIsNotAPipe) {
  const process::UniqueFd folder(::open("/", O_RDONLY | O_DIRECTORY));
  const process::UniqueFd event(::eventfd(0, EFD_NONBLOCK));
  for (const process::UniqueFd* other : {&folder, &event}) {
    greet({memory->fd(), other->get()});
    EXPECT_EQ(answer()->refusal, Refusal::invalid_memory);
    EXPECT_TRUE(lost());
  }
}

TEST(OpenWake, OpensThePipeAnewSoThatTheOtherNodeCannotMakeUsWaitInIt) {
  WakePipe pipe;
  const process::UniqueFd ours = open_wake(pipe.reading);
  make_it_wait(pipe.reading);
  char byte;
  EXPECT_EQ(::read(ours.get(), &byte, 1), -1);
  EXPECT_EQ(errno, EAGAIN);
}

TEST_F(MemoryInputFromHand, IsWokenHoweverOftenItWasWokenBefore) {
  connect();
  while (::write(pipe.writing.get(), "", 1) == 1) continue;
  ASSERT_TRUE(rig.until([&] { return ::write(pipe.writing.get(), "", 1) == 1; })) << "nobody empties it";
  wire::SliceWriter slices;
  put_whole(slices, 20, 6);
  put(slices);
  ASSERT_TRUE(rig.until([&] { return heard.slices.size() == 1; }));
}

TEST_F(MemoryInputFromHand, EndsTheLineOnAnImpossibleIndex) {
  connect();
  memory->control().written.store(1u << 30);
  pipe.wake();
  ASSERT_TRUE(rig.until([&] { return lost(); }));
  EXPECT_EQ(counters().queue_invalid, 1u);
  EXPECT_THAT(heard.log, ElementsAre("up 0", HasSubstr("shared memory is invalid")));
}

TEST_F(MemoryInputFromHand, EndsTheLineOnAnInvalidSlice) {
  connect();
  const std::vector<std::uint8_t> garbage(50, 0xFF);
  queue.put({garbage.data(), garbage.size()});
  pipe.wake();
  ASSERT_TRUE(rig.until([&] { return lost(); }));
  EXPECT_EQ(counters().malformed, 1u);
}

// Over all of it, again and again while the other end reads: every slice handed on is one that could have been sent.
TEST_F(MemoryInputFromHand, SurvivesAPeerThatOverwritesTheWholeMemory) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    memory = QueueMemory::make(QueueMemory::kSmallest);
    queue = QueueWriter(*memory);
    connect();
    for (int i = 0; i < 20 && !lost(); ++i) {
      wire::SliceWriter slices;
      put_whole(slices, 13 + random() % 512, static_cast<std::uint8_t>(i));
      queue.put(slices.view());
      auto* all = reinterpret_cast<std::uint8_t*>(&memory->control());
      const std::size_t size = random() % 2 == 0 ? 128 : 128 + memory->capacity();
      for (int n = 0; n < 20; ++n) all[random() % size] = static_cast<std::uint8_t>(random());
      pipe.wake();
      rig.run_for(milliseconds(0));
    }
    line.reset();
    ASSERT_TRUE(rig.until([&] { return lost(); })) << "round " << round;
  }
  for (const auto& slice : heard.slices) ASSERT_LE(slice.size(), wire::kMaxDataPacketSize);
}

/// Node 0's output, with this test as node 1.
struct MemoryOutputToHand : testing::Test {
  LinkRig rig{2, Endpoint::Transport::shm};
  boost::asio::io_context io;
  event_loop::UnixListener door{io, rig.endpoint(1).path};
  process::UniqueFd line;
  std::vector<process::UniqueFd> offered;
  std::optional<QueueMemory> memory;

  void SetUp() override {
    door.acceptor().non_blocking(true);
    rig.start_output(0);
    std::array<std::uint8_t, kConnectSize> bytes;
    ASSERT_TRUE(rig.until([&] {
      if (!line.valid()) line = process::UniqueFd(::accept(door.acceptor().native_handle(), nullptr, nullptr));
      return line.valid() && receive_now(line.get(), bytes.data(), bytes.size(), offered) > 0;
    }));
    ASSERT_EQ(parse_header({bytes.data(), bytes.size()})->type, LinkHeaderType::connect_memory);
    ASSERT_EQ(offered.size(), 2u);
    memory = QueueMemory::open(std::move(offered[0]));
    ASSERT_TRUE(memory);
    LinkHeader accept;
    accept.type = LinkHeaderType::accept;
    accept.ring = LinkRig::kRing;
    accept.sender = 1;
    const auto answer = encode(accept);
    send_now(line.get(), {answer.data(), answer.size()});
    ASSERT_TRUE(rig.until([&] { return rig.node(0).output->up(); }));
  }
  void write(std::size_t packets) {
    wire::SliceWriter slices;
    for (std::size_t i = 0; i < packets; ++i) put_whole(slices, 524, 1);
    rig.node(0).output->write(slices.view());
  }
};

TEST_F(MemoryOutputToHand, WakesTheReaderThatSleeps) {
  QueueReader reader(*memory);
  ASSERT_TRUE(reader.sleep());
  write(1);
  std::array<char, 8> woken;
  EXPECT_EQ(::read(offered[1].get(), woken.data(), woken.size()), 1);
}

TEST_F(MemoryOutputToHand, DoesNotWaitForAReaderThatLetsItsPipeRunFull) {
  make_it_wait(offered[1]);
  const std::string path = "/proc/self/fd/" + std::to_string(offered[1].get());
  const process::UniqueFd writing(::open(path.c_str(), O_WRONLY | O_NONBLOCK));
  while (::write(writing.get(), "", 1) == 1) continue;
  QueueReader reader(*memory);
  ASSERT_TRUE(reader.sleep());
  write(1);
  EXPECT_EQ(memory->control().written.load(), 528u);
}

TEST_F(MemoryOutputToHand, KeepsWhatThereIsNoRoomForUntilThereIs) {
  QueueReader reader(*memory);
  write(20);
  EXPECT_EQ(rig.node(0).output->counters().blocked, 1u);
  EXPECT_TRUE(rig.node(0).output->ready()) << "a ring that opens sends at once what has waited in all nodes";
  write(600);
  EXPECT_FALSE(rig.node(0).output->ready());
  std::vector<std::uint8_t> space(64 * 1024);
  std::size_t all = 0;
  LinkHeader alive;
  alive.ring = LinkRig::kRing;
  const auto header = encode(alive);
  ASSERT_TRUE(rig.until([&] {
    reader.beat();
    all += static_cast<std::size_t>(reader.take(space.data(), space.size()));
    if (reader.must_tell_of_room()) send_now(line.get(), {header.data(), header.size()});
    return rig.node(0).said.ready == 1;
  }));
  all += static_cast<std::size_t>(reader.take(space.data(), space.size()));
  EXPECT_EQ(all, 620u * (524 + 4));
}

TEST_F(MemoryOutputToHand, EndsTheLineOnAnImpossibleIndex) {
  memory->control().read.store(1u << 30);
  write(1);
  ASSERT_TRUE(rig.until([&] { return rig.node(0).output->counters().queue_invalid == 1; }));
  ASSERT_TRUE(rig.until([&] { return !rig.node(0).said.log.empty() && rig.node(0).said.log.size() > 1; }));
  EXPECT_THAT(rig.node(0).said.log[1], HasSubstr("shared memory is invalid"));
}

}  // namespace
}  // namespace limb_ring::link
