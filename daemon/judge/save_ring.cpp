#include "judge/save_ring.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "judge/recorder_file.h"

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

void remove_old_saves(const std::string& newest, const std::string& prefix, std::size_t keep) {
  using Age = std::pair<bool, fs::file_time_type>;  // one from the future was made before the clock was set back
  std::vector<std::pair<Age, fs::path>> others;
  std::error_code error;
  const auto now = fs::file_time_type::clock::now();
  const fs::path kept = fs::path(newest).filename();
  for (fs::directory_iterator it(fs::path(newest).parent_path(), error), end; !error && it != end;
       it.increment(error)) {
    const fs::path name = it->path().filename();
    if (name == kept || !is_save(name.string(), prefix) || !it->is_directory(error)) continue;
    const auto made = it->last_write_time(error);
    others.push_back({{made <= now, made}, it->path()});
  }
  std::sort(others.begin(), others.end());
  for (std::size_t i = 0; i + keep < others.size() + 1; ++i) fs::remove_all(others[i].second, error);
}

}  // namespace limb_ring::recorder
