#include "tools/ringctl/saved_lives.h"

#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <vector>

#include "judge/recorder_file.h"
#include "judge/recording.h"
#include "ring/lock_files.h"

namespace limb_ring::ringctl {
namespace {

std::string date_of(std::int64_t ns) {
  const std::time_t seconds = ns / 1'000'000'000;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local);
  return text;
}

/// One that cannot be read says so when it is replayed.
std::string ended_life(const std::string& ring_folder, const std::string& file) try {
  std::vector<std::uint8_t> bytes(recorder::kTitleSize);
  std::ifstream(file, std::ios::binary)
      .read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const recorder::Title title = recorder::read_title({bytes.data(), bytes.size()});
  if (!recorder::is_of_former_life(file) && live::holder_of(ring_folder, title.settings.id).held) return "";
  return "  " + std::filesystem::path(file).filename().string() + ": " + title.node + ", begun " + date_of(title.date) +
         '\n';
} catch (const std::exception&) {
  return "";
}

}  // namespace

std::string ended_lives(const std::string& ring_folder, const std::string& folder) {
  std::string lines;
  for (const std::string& file : recorder::recordings_in(folder)) lines += ended_life(ring_folder, file);
  return lines;
}

}  // namespace limb_ring::ringctl
