// Old saves go, and only those of the ring.
#include "recorder/save_ring.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "support/temporary_folder.h"

namespace limb_ring::recorder {
namespace {

namespace fs = std::filesystem;

TEST(OldSaves, goAndThoseOfAnotherRingWhoseNameBeginsAlikeStay) {
  const test::TemporaryFolder temporary;
  const std::string& folder = temporary.path();
  const std::string mine = "leg-2026-11-23_061508_123-crash", newer = "leg-2026-11-23_061600_000-break";
  const std::string others = "leg-8-2026-11-22_061508_123-crash", own = "leg-notes";
  for (const std::string& name : {mine, newer, others, own}) fs::create_directories(folder + '/' + name);
  remove_old_saves(folder, "leg-", 1);
  EXPECT_FALSE(fs::exists(folder + '/' + mine));
  for (const std::string& name : {newer, others, own}) EXPECT_TRUE(fs::exists(folder + '/' + name)) << name;
}

}  // namespace
}  // namespace limb_ring::recorder
