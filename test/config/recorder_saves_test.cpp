// When recordings are saved by themselves, and where.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "config/ring_config.h"
#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RecorderSaves saves_of(const std::string& recorder, bool records = true) {
  const auto path = std::filesystem::temp_directory_path() / ("saves" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(path) << two_nodes(recorder);
  try {
    const RecorderSaves saves = load_recorder_saves(path.string(), records);
    std::filesystem::remove(path);
    return saves;
  } catch (const ConfigError&) {
    std::filesystem::remove(path);
    throw;
  }
}

TEST(RecorderSaves, AreOffUnlessTheFileSaysWhen) {
  EXPECT_THAT(saves_of("").when, IsEmpty());
  EXPECT_THAT(saves_of("recorder: {enabled: true}\n").when, IsEmpty());
}

TEST(RecorderSaves, HaveTheFolderAndNumberThatTheFileGives) {
  const RecorderSaves saves = saves_of("recorder: {enabled: true, save: [crash, promise], folder: saves, keep: 3}\n");
  EXPECT_THAT(saves.when, ElementsAre("crash", "promise"));
  EXPECT_EQ(saves.folder, (std::filesystem::temp_directory_path() / "saves").string());
  EXPECT_EQ(saves.keep, 3u);
  EXPECT_EQ(saves_of("recorder: {save: [break], folder: /var/saves}\n").folder, "/var/saves");
}

TEST(RecorderSaves, LieInTheUsersStateFolderByDefault) {
  ::setenv("XDG_STATE_HOME", "/some/state", 1);
  EXPECT_EQ(saves_of("recorder: {save: [crash]}\n").folder, "/some/state/limb_ring");
  ::unsetenv("XDG_STATE_HOME");
}

TEST(RecorderSaves, AreRefusedWithTheirPlaceIfNothingIsRecorded) {
  try {
    saves_of("recorder:\n  folder: saves\n  save: [crash]\n", /*records=*/false);
    FAIL() << "nothing is recorded";
  } catch (const ConfigError& wrong) {
    EXPECT_THAT(wrong.what(), ContainsRegex(":[0-9]+:[0-9]+: entry 'recorder.save': nothing is recorded"));
  }
  EXPECT_THAT(saves_of("recorder: {folder: saves}\n", /*records=*/false).when, IsEmpty());
}

TEST(RecorderSaves, OfAnotherKindAreRefused) {
  EXPECT_THAT(refusal_of(two_nodes("recorder: {save: [fire]}\n")), HasSubstr("allowed: crash, break, promise"));
  EXPECT_THAT(refusal_of(two_nodes("recorder: {save: crash}\n")), HasSubstr("a list of crash, break, promise"));
  EXPECT_THAT(refusal_of(two_nodes("recorder: {keep: 0}\n")), HasSubstr("entry 'recorder.keep'"));
}

}  // namespace
}  // namespace limb_ring::config
