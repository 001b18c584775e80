// A new process of a node goes on from the boot number of the former one.
#include "node/node_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/temporary_folder.h"
#include "wire/packet.h"

namespace limb_ring::runtime {
namespace {

struct BootRecordTest : testing::Test {
  test::TemporaryFolder temporary;
  const std::filesystem::path folder = temporary.path();
  BootRecord open() { return BootRecord(folder.string(), 7); }
};

TEST_F(BootRecordTest, WithoutAFormerProcessItIsTheTime) { EXPECT_EQ(open().first(1'000'000'001), 1'000'000'001u); }

TEST_F(BootRecordTest, TheNextProcessHasAHigherOneOfTheNextIncarnation) {
  for (std::uint64_t former : {1000u, 1001u, 1002u, 1003u}) {
    BootRecord(folder.string(), 7).note(former);
    for (std::uint64_t now = 5000; now < 5008; ++now) {
      const std::uint64_t first = open().first(now);
      EXPECT_GT(first, now);
      EXPECT_EQ(wire::incarnation_of(first), wire::incarnation_of(former + 1)) << former << ", " << now;
    }
  }
}

TEST_F(BootRecordTest, AClockThatWasSetBackMakesItNoLower) {
  BootRecord(folder.string(), 7).note(9000);
  EXPECT_EQ(open().first(5000), 9001u);
}

TEST_F(BootRecordTest, ItIsTheLastOneNoted) {
  {
    BootRecord record(folder.string(), 7);
    record.note(1000);
    record.note(1001);
  }
  EXPECT_EQ(open().first(10), 1002u);
}

TEST_F(BootRecordTest, AFileWithoutANumberCountsAsMissing) {
  std::ofstream(folder / "7.boot") << "abc";
  EXPECT_EQ(open().first(5000), 5000u);
}

TEST_F(BootRecordTest, WhatALinkInItsPlaceLeadsToIsLeftAlone) {
  std::ofstream(folder / "precious") << "precious";
  std::filesystem::create_symlink("precious", folder / "7.boot");
  BootRecord record = open();
  record.note(1000);
  EXPECT_EQ(record.first(10), 1001u);
  EXPECT_EQ(open().first(10), 10u);
  std::string left;
  std::ifstream(folder / "precious") >> left;
  EXPECT_EQ(left, "precious");
}

TEST_F(BootRecordTest, IfNoFileCanBeMadeItIsTheTime) {
  BootRecord record((folder / "no" / "such").string(), 7);
  record.note(1000);
  EXPECT_EQ(BootRecord((folder / "no" / "such").string(), 7).first(5000), 5000u);
}

}  // namespace
}  // namespace limb_ring::runtime
