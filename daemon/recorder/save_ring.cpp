#include "recorder/save_ring.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "recorder/recorder_file.h"

namespace limb_ring::recorder {

namespace fs = std::filesystem;

SavedRing save_ring(const std::string& ring_folder, const std::string& to) {
  SavedRing saved;
  for (const std::string& recording : recordings_in(ring_folder)) {
    try {
      fs::create_directories(to);
      saved.bytes += save_file(recording, (fs::path(to) / fs::path(recording).filename()).string());
    } catch (const std::exception& problem) {
      throw std::runtime_error(recording + ": " + problem.what());
    }
    ++saved.recordings;
  }
  return saved;
}

void remove_old_saves(const std::string& folder, const std::string& prefix, std::size_t keep) {
  std::vector<fs::path> saves;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().filename().string().rfind(prefix, 0) == 0 && it->is_directory(error)) saves.push_back(it->path());
  std::sort(saves.begin(), saves.end());
  for (std::size_t i = 0; i + keep < saves.size(); ++i) fs::remove_all(saves[i], error);
}

}  // namespace limb_ring::recorder
