#include "config/names.h"

#include <algorithm>
#include <numeric>

#include "config/characters.h"

namespace limb_ring::config {
namespace {

/// Letters, digits and `others` alone, 1 to `most` characters.
bool consists_of(const std::string& name, const std::string& others, std::size_t most) {
  return !name.empty() && name.size() <= most && std::all_of(name.begin(), name.end(), [&](char c) {
    return is_letter(c) || is_digit(c) || others.find(c) != std::string::npos;
  });
}

/// Levenshtein's distance: insertions, deletions and replacements between two words.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

bool is_node_name(const std::string& name) { return consists_of(name, "_", 32) && is_letter(name[0]) && name != "all"; }

bool is_host_name(const std::string& name) { return is_part_name(name) && name != "all"; }

bool is_part_name(const std::string& name) { return consists_of(name, "_-.", 64) && is_letter(name[0]); }

bool is_joint_name(const std::string& name) {
  return consists_of(name, "_-./", 64) && name[0] != '-' && name[0] != '.';
}

bool is_sensor_name(const std::string& name) { return consists_of(name, "_", 64) && is_letter(name[0]); }

bool is_topic_name(const std::string& name) {
  if (name.empty() || !(is_letter(name[0]) || name[0] == '/')) return false;
  const bool tidy = name.find("//") == std::string::npos && name.back() != '/';
  return tidy && consists_of(name, "_/", 200);
}

std::string closest(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.size() > 64) return {};  // no typing error, and the search is quadratic
  std::string best;
  // Two edits at least, as two swapped letters are; but some of the word must be left.
  std::size_t least = std::min(word.size() / 4 + 2, word.size());
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= least) continue;
    least = distance;
    best = candidate;
  }
  return best;
}

std::string join(const std::vector<std::string>& words, const std::string& between) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : between) + word;
  return all;
}

}  // namespace limb_ring::config
