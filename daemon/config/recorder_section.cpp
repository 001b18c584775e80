#include <cstdlib>
#include <filesystem>

#include "config/recorder_saves.h"
#include "config/sections.h"
#include "config/yaml_file.h"

namespace limb_ring::config {
namespace {

const std::vector<std::string> kSaveWords{"crash", "break", "promise"};
constexpr const char* kSaveRule = "a list of crash, break, promise";
constexpr const char* kFolderRule = "a path, from the folder of this file, or absolute";

void read_save(const Entry& entry, RecorderSaves& saves) {
  saves.when.clear();
  for (const Entry& item : entry.items(kSaveRule, kSaveWords.size()))
    saves.when.push_back(kSaveWords[read_choice(item, kSaveWords)]);
}

const Section<RecorderSaves>& saves_section() {
  static const Section<RecorderSaves> section{
      {"save", "[]", kSaveRule,
       "When the recordings of all nodes are saved by themselves, by `ringctl up`: crash: a daemon ends that nobody "
       "has "
       "ended; break: a broken line is located; promise: one is broken, for which the ring is watched as `ringctl "
       "judge` does.",
       read_save},
      {"folder", "`~/.local/state/limb_ring`", kFolderRule,
       "There each save is a folder, named by ring, date and reason. The default is $XDG_STATE_HOME/limb_ring where "
       "that "
       "is set.",
       [](const Entry& entry, RecorderSaves& saves) { saves.folder = entry.text(kFolderRule); }},
      integer_option("keep", &RecorderSaves::keep, {1, 1000}, "So many saves of the ring are kept, the newest."),
  };
  return section;
}

std::string usual_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return std::string(state) + "/limb_ring";
  const char* home = std::getenv("HOME");
  return std::string(home != nullptr ? home : "/tmp") + "/.local/state/limb_ring";
}

}  // namespace

// The options of saving are only checked here; `ringctl up`, which saves, reads them (recorder_saves.h).
const Section<RecorderConfig>& recorder_section() {
  static const Section<RecorderConfig> section = [] {
    Section<RecorderConfig> all{
        flag_option("enabled", &RecorderConfig::enabled, "Record, on a live ring; as `ringctl up --record`."),
        integer_option("size", &RecorderConfig::size, {1u << 20, 1u << 30},
                       "Bytes of each node's file; the newest stays. It lies in the ring's folder."),
    };
    for (const Option<RecorderSaves>& option : saves_section())
      all.push_back({option.name, option.fallback, option.allowed, option.meaning,
                     [read = option.read](const Entry& entry, RecorderConfig&) {
                       RecorderSaves checked;
                       read(entry, checked);
                     }});
    return all;
  }();
  return section;
}

RecorderSaves load_recorder_saves(const std::string& path, bool records) {
  Document document;
  document.name = path;
  const Entry file(parse_yaml(read_file(path), path), "", document);
  RecorderSaves saves;
  if (const auto recorder = file.find("recorder")) {
    for (const Option<RecorderSaves>& option : saves_section())
      if (const auto entry = recorder->find(option.name)) option.read(*entry, saves);
    if (!saves.when.empty() && !records)
      recorder->find("save")->refuse("nothing is recorded, so nothing can be saved",
                                     "with enabled: true, or 'ringctl up --record'");
  }
  const auto beside = std::filesystem::absolute(path).parent_path();
  saves.folder = saves.folder.empty() ? usual_folder() : (beside / saves.folder).lexically_normal().string();
  return saves;
}

}  // namespace limb_ring::config
