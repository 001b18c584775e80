#include "tools/scenario_cpu/taken_board.h"

#include "support/own_folder.h"

namespace limb_ring::scenario_cpu {
namespace {

using Board = test::OwnFolder;

TEST_F(Board, ShowsEverybodyWhatACpuHasCounted) {
  TakenBoard cpu("r", 3), scenario("r", 3);
  cpu.count(7);
  cpu.count(7);
  cpu.count(255);
  EXPECT_EQ(scenario.of(7), 2u);
  EXPECT_EQ(scenario.of(255), 1u);
  EXPECT_EQ(scenario.of(0), 0u);
}

TEST_F(Board, OutlivesItsCpuAndGoesOnWithTheNext) {
  { TakenBoard("r", 3).count(1); }
  TakenBoard next("r", 3);
  next.count(1);
  EXPECT_EQ(next.of(1), 2u);
}

TEST_F(Board, IsOfOneNodeOnly) {
  TakenBoard("r", 3).count(1);
  EXPECT_EQ(TakenBoard("r", 4).of(1), 0u);
}

TEST_F(Board, NamesTheFileThatItCannotUse) {
  TakenBoard("r", 3);
  std::filesystem::remove(folder + "/limb_ring/r/3.taken");
  std::filesystem::create_directory(folder + "/limb_ring/r/3.taken");
  try {
    TakenBoard("r", 3);
    FAIL() << "a folder was taken for a file";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("3.taken"), std::string::npos);
  }
}

}  // namespace
}  // namespace limb_ring::scenario_cpu
