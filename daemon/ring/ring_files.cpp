#include "ring/ring_files.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <system_error>

#include "config/characters.h"
#include "io/throw_errno.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::live {

namespace fs = std::filesystem;

namespace {

/// A note whose writer was killed (node_notes.cpp): 3.fault.4711
bool is_unfinished_note(const fs::path& file) {
  const std::string pid = file.extension(), kind = file.stem().extension();
  return !pid.empty() && config::are_digits(pid.substr(1)) && (kind == ".fault" || kind == ".killed");
}

bool is_leftover(const fs::path& file) {
  constexpr std::array ours{".boot", ".fault", ".former", ".host", ".killed", ".link",  ".link2",
                            ".lock", ".log",   ".new",    ".read", ".record", ".taken", ".watch"};
  return is_unfinished_note(file) ||
         std::any_of(ours.begin(), ours.end(), [&](const char* extension) { return file.extension() == extension; });
}

}  // namespace

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  if (!why_not_private(folder).empty()) return files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    files.push_back(it->path());
  if (process::is_shortage(error.value())) throw std::system_error(error, "cannot look into " + folder);
  return files;
}

std::optional<std::uint8_t> node_of(const std::string& file, const std::string& kind) {
  const std::string digits = fs::path(file).stem();
  if (fs::path(file).extension() != kind || !config::are_digits(digits, 3) || std::stoi(digits) > 254)
    return std::nullopt;
  return static_cast<std::uint8_t>(std::stoi(digits));
}

std::string kept_logs(const std::string& folder) {
  const fs::path path(folder);
  return path.parent_path() / ".logs" / path.filename();
}

void forget_logs(const std::string& folder) {
  std::error_code ignored;
  fs::remove_all(kept_logs(folder), ignored);
}

namespace {

/// Of a file system that is full or read-only they go the way of the others.
void keep_logs(const std::vector<std::string>& logs, const std::string& folder) {
  std::error_code ignored;
  if (logs.empty()) return;
  forget_logs(folder);
  fs::create_directories(kept_logs(folder), ignored);
  for (const fs::path log : logs) fs::rename(log, fs::path(kept_logs(folder)) / log.filename(), ignored);
}

}  // namespace

void remove_leftovers(const std::string& folder) {
  std::error_code ignored;
  std::vector<std::string> logs;
  const std::vector<std::string> files = files_in(folder);
  std::copy_if(files.begin(), files.end(), std::back_inserter(logs),
               [](const fs::path file) { return file.extension() == ".log"; });
  keep_logs(logs, folder);
  for (const std::string& file : files)
    if (is_leftover(file)) fs::remove(file, ignored);
  fs::remove(folder, ignored);
}

}  // namespace limb_ring::live
