#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace limb_ring::config {

/// A configuration that is refused. what() reads
/// `FILE:LINE:COLUMN: entry 'timeouts.send': '12 parsec' is not a time; allowed: a time such as
/// 100ms, 1ms to 60s`; lines and columns count from 1. Several problems are a line each.
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What is wrong with one file, gathered so that a reader says all of it at once. (ours)
class Problems {
 public:
  static constexpr std::size_t kMost = 50;  ///< of further ones there is a last line

  /// Does that, and notes the ConfigError in which it ends.
  /// @return it came to its end
  template <typename Work>
  bool gather(Work&& work) {
    try {
      work();
      return true;
    } catch (const ConfigError& error) {
      add(error.what());
      return false;
    }
  }
  /// One problem or several, a line each; a line that is known already is not noted again. Empty: something failed
  /// only because of another problem, which somebody else says.
  void add(const std::string& lines) {
    failed_ = true;
    for (std::size_t at = 0; at < lines.size();) {
      const std::size_t end = std::min(lines.find('\n', at), lines.size());
      const std::string line = lines.substr(at, end - at);
      at = end + 1;
      if (std::find(lines_.begin(), lines_.end(), line) != lines_.end()) continue;
      if (lines_.size() < kMost) lines_.push_back(line);
      if (lines_.size() == kMost) lines_.back() = "There are more problems than these.";
    }
  }
  /// @throw ConfigError with everything noted, if there is anything
  void refuse_all() const {
    if (!failed_) return;
    std::string all;
    for (const std::string& line : lines_) all += (all.empty() ? "" : "\n") + line;
    throw ConfigError(all);
  }

 private:
  bool failed_ = false;
  std::vector<std::string> lines_;
};

}  // namespace limb_ring::config
