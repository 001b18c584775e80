// When recordings are saved by themselves, and where.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "config/recorder_saves.h"
#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RecorderSaves saves_of(const std::string& recorder) {
  const auto path = std::filesystem::temp_directory_path() / ("saves" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(path) << two_nodes(recorder);
  const RecorderSaves saves = load_recorder_saves(path.string());
  std::filesystem::remove(path);
  return saves;
}

TEST(RecorderSaves, AreNoneWhereTheFileDoesNotSayWhen) {
  EXPECT_THAT(saves_of("").when, IsEmpty());
  EXPECT_THAT(saves_of("recorder: {enabled: true}\n").when, IsEmpty());
}

TEST(RecorderSaves, AreWhatTheFileSaysBesideIt) {
  const RecorderSaves saves = saves_of("recorder: {enabled: true, save: [crash, promise], folder: saves, keep: 3}\n");
  EXPECT_THAT(saves.when, ElementsAre("crash", "promise"));
  EXPECT_EQ(saves.folder, (std::filesystem::temp_directory_path() / "saves").string());
  EXPECT_EQ(saves.keep, 3u);
  EXPECT_EQ(saves_of("recorder: {save: [break], folder: /var/saves}\n").folder, "/var/saves");
}

TEST(RecorderSaves, LieWhereStateDoesElse) {
  ::setenv("XDG_STATE_HOME", "/some/state", 1);
  EXPECT_EQ(saves_of("recorder: {save: [crash]}\n").folder, "/some/state/limb_ring");
  ::unsetenv("XDG_STATE_HOME");
}

TEST(RecorderSaves, OfAnotherKindAreRefused) {
  EXPECT_THAT(refusal_of(two_nodes("recorder: {save: [fire]}\n")), HasSubstr("allowed: crash, break, promise"));
  EXPECT_THAT(refusal_of(two_nodes("recorder: {save: crash}\n")), HasSubstr("a list of crash, break, promise"));
  EXPECT_THAT(refusal_of(two_nodes("recorder: {keep: 0}\n")), HasSubstr("entry 'recorder.keep'"));
}

}  // namespace
}  // namespace limb_ring::config
