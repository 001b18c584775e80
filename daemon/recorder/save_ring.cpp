#include "recorder/save_ring.h"

#include <algorithm>
#include <filesystem>

#include "recorder/recorder_file.h"

namespace limb_ring::recorder {

namespace fs = std::filesystem;

namespace {

/// A save of that ring: behind the prefix stands a date. Ring `leg` keeps away from those of ring `leg-8`.
bool is_save(const std::string& name, const std::string& prefix) {
  static const std::string kDate = "0000-00-00_";
  if (name.rfind(prefix, 0) != 0 || name.size() < prefix.size() + kDate.size()) return false;
  return std::equal(kDate.begin(), kDate.end(), name.begin() + static_cast<std::ptrdiff_t>(prefix.size()),
                    [](char form, char c) { return form == '0' ? c >= '0' && c <= '9' : form == c; });
}

}  // namespace

SavedRing save_ring(const std::string& ring_folder, const std::string& to) {
  SavedRing saved;
  for (const std::string& recording : recordings_in(ring_folder)) {
    fs::create_directories(to);
    try {
      saved.bytes += save_file(recording, (fs::path(to) / fs::path(recording).filename()).string());
      ++saved.recordings;
    } catch (const std::exception& problem) {
      saved.problems.push_back(recording + ": " + problem.what());
    }
  }
  return saved;
}

void remove_old_saves(const std::string& folder, const std::string& prefix, std::size_t keep) {
  std::vector<fs::path> saves;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (is_save(it->path().filename().string(), prefix) && it->is_directory(error)) saves.push_back(it->path());
  std::sort(saves.begin(), saves.end());
  for (std::size_t i = 0; i + keep < saves.size(); ++i) fs::remove_all(saves[i], error);
}

}  // namespace limb_ring::recorder
