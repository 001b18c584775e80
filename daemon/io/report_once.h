#pragma once

#include <set>
#include <string>
#include <string_view>

namespace limb_ring::link {

/// True for a text that was not reported yet: a node that is turned away comes again many times a second.
class ReportOnce {
 public:
  bool operator()(std::string_view text) { return reported_.size() < kMost && reported_.emplace(text).second; }
  void forget() { reported_.clear(); }

 private:
  static constexpr std::size_t kMost = 16;
  std::set<std::string> reported_;
};

}  // namespace limb_ring::link
