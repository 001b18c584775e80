#include "io/memory_line.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <numeric>
#include <thread>
#include <vector>

#include "support/view.h"

namespace limb_ring::link {
namespace {

using test::view;

struct Queue : testing::Test {
  std::optional<QueueMemory> memory = QueueMemory::make(QueueMemory::kSmallest);
  QueueWriter writer{*memory};
  QueueReader reader{*memory};

  std::vector<std::uint8_t> take(std::size_t most) {
    std::vector<std::uint8_t> bytes(most);
    const auto got = reader.take(bytes.data(), bytes.size());
    EXPECT_GE(got, 0);
    bytes.resize(static_cast<std::size_t>(got));
    return bytes;
  }
};

std::vector<std::uint8_t> numbered(std::size_t size, std::uint8_t first) {
  std::vector<std::uint8_t> bytes(size);
  std::iota(bytes.begin(), bytes.end(), first);
  return bytes;
}

TEST_F(Queue, GivesBackWhatWasPutInOrderAlsoAroundItsEnd) {
  for (std::size_t round = 0; round < 100; ++round) {
    const auto bytes = numbered(1000 + round, static_cast<std::uint8_t>(round));
    ASSERT_EQ(writer.put(view(bytes)), static_cast<std::ptrdiff_t>(bytes.size()));
    ASSERT_EQ(take(5000), bytes);
  }
}

TEST_F(Queue, TakesWhatThereIsRoomForAndNoMore) {
  const auto bytes = numbered(5000, 7);
  EXPECT_EQ(writer.put(view(bytes)), 4096);
  EXPECT_EQ(writer.put(view(bytes)), 0);
  EXPECT_EQ(take(96).size(), 96u);
  EXPECT_EQ(writer.put(view(bytes).from(4096)), 96);
}

TEST_F(Queue, TheReaderIsWokenOnceIfItSleeps) {
  const auto bytes = numbered(10, 0);
  writer.put(view(bytes));
  EXPECT_FALSE(writer.must_wake()) << "it never said that it sleeps";
  EXPECT_FALSE(reader.sleep()) << "something is there";
  take(100);
  EXPECT_TRUE(reader.sleep());
  writer.put(view(bytes));
  EXPECT_TRUE(writer.must_wake());
  EXPECT_FALSE(writer.must_wake());
}

TEST_F(Queue, TheWriterIsToldOfRoomIfItWaits) {
  const auto bytes = numbered(5000, 0);
  writer.put(view(bytes));
  EXPECT_TRUE(writer.wait_for_room());
  take(1);
  EXPECT_TRUE(reader.must_tell_of_room());
  EXPECT_FALSE(reader.must_tell_of_room());
  EXPECT_FALSE(writer.wait_for_room()) << "there is some by now";
}

TEST_F(Queue, ABeatIsHeardOnce) {
  EXPECT_FALSE(reader.heard_beat());
  writer.beat();
  EXPECT_TRUE(reader.heard_beat());
  EXPECT_FALSE(reader.heard_beat());
  reader.beat();
  EXPECT_TRUE(writer.heard_beat());
}

TEST_F(Queue, AnImpossibleIndexIsNotBelieved) {
  std::uint8_t space[100];
  memory->control().written.store(QueueMemory::kSmallest + 1);
  EXPECT_EQ(reader.take(space, sizeof space), -1);
  memory->control().read.store(1);
  EXPECT_EQ(writer.put(view(numbered(1, 0))), -1) << "nothing has been written yet";
}

TEST_F(Queue, CarriesEverythingBetweenTwoThreads) {
  constexpr std::size_t kTotal = 2'000'000;
  std::thread other([this] {
    std::size_t sent = 0;
    while (sent < kTotal) {
      const auto bytes = numbered(std::min<std::size_t>(700, kTotal - sent), static_cast<std::uint8_t>(sent));
      const auto put = writer.put(view(bytes));
      if (put == 0) std::this_thread::yield();
      sent += static_cast<std::size_t>(put);
    }
  });
  std::size_t got = 0;
  bool right = true;
  while (got < kTotal) {
    const auto bytes = take(600);
    if (bytes.empty()) std::this_thread::yield();
    for (const std::uint8_t byte : bytes) right = right && byte == static_cast<std::uint8_t>(got++);
  }
  other.join();
  EXPECT_TRUE(right);
}

TEST(QueueMemory, OfAnotherProcessIsMappedIfItsSizeIsSealed) {
  const auto made = QueueMemory::make(1 << 14);
  ASSERT_TRUE(made);
  const auto opened = QueueMemory::open(process::UniqueFd(::dup(made->fd())));
  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->capacity(), 1u << 14);
}

TEST(QueueMemory, ThatCouldStillBeCutOffIsNotMapped) {
  process::UniqueFd unsealed(::memfd_create("test", MFD_ALLOW_SEALING));
  ASSERT_EQ(::ftruncate(unsealed.get(), 128 + 4096), 0);
  EXPECT_FALSE(QueueMemory::open(process::UniqueFd(::dup(unsealed.get()))));
  ASSERT_EQ(::fcntl(unsealed.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW), 0);
  EXPECT_TRUE(QueueMemory::open(std::move(unsealed)));
}

TEST(QueueMemory, OfAnySizeButTheProtocolsIsNotMapped) {
  for (const off_t size : {0, 127, 128, 128 + 4095, 128 + 4097, 128 + (2 << 20)}) {
    process::UniqueFd memory(::memfd_create("test", MFD_ALLOW_SEALING));
    ASSERT_EQ(::ftruncate(memory.get(), size), 0);
    ASSERT_EQ(::fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW), 0);
    EXPECT_FALSE(QueueMemory::open(std::move(memory))) << size;
  }
  EXPECT_FALSE(QueueMemory::open(process::UniqueFd(::open("/dev/null", O_RDWR))));
}

TEST(QueueMemory, HoldsAFullPacketOfEachNode) {
  EXPECT_EQ(queue_capacity(2), QueueMemory::kSmallest);
  EXPECT_EQ(queue_capacity(16), 1u << 14);
  EXPECT_EQ(queue_capacity(254), 1u << 18);
}

}  // namespace
}  // namespace limb_ring::link
