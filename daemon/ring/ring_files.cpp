#include "ring/ring_files.h"

#include <algorithm>
#include <array>
#include <filesystem>
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
  constexpr std::array ours{".boot", ".fault", ".former", ".host",   ".killed", ".link", ".link2",
                            ".lock", ".log",   ".new",    ".record", ".taken",  ".watch"};
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

void remove_leftovers(const std::string& folder) {
  std::error_code ignored;
  for (const std::string& file : files_in(folder))
    if (is_leftover(file)) fs::remove(file, ignored);
  fs::remove(folder, ignored);
}

}  // namespace limb_ring::live
