#pragma once

#include <string>

#include "io/unique_fd.h"

namespace limb_ring::bridge {

/// A text that outlives its writer: of this process and of those that it starts by fork, one after the other.
class KeptText {
 public:
  /// Empty. Where the system has no room for it, it stays so.
  KeptText();
  void put(const std::string& text) const;
  std::string get() const;

 private:
  process::UniqueFd file_;
};

}  // namespace limb_ring::bridge
