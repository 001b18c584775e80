#pragma once

#include <set>
#include <string>
#include <string_view>

namespace limb_ring::link {

/// Tells a text that has not been said yet from one that has: who is turned away comes again many times a second.
class ReportOnce {
 public:
  bool operator()(std::string_view text) {
    return said_.size() < kMost && said_.emplace(text).second;
  }
  void forget() { said_.clear(); }

 private:
  static constexpr std::size_t kMost = 16;
  std::set<std::string> said_;
};

}  // namespace limb_ring::link
