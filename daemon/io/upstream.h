#pragma once

#include "io/input_line.h"

namespace limb_ring::link {

/// Who is the upstream neighbour of an input: one at a time, whichever of its lines it came in by. (ours, protocol.md
/// section 6.8)
class Upstream {
 public:
  std::optional<std::uint8_t> from() const { return line_ == nullptr ? std::nullopt : line_->from(); }
  /// Node `by` comes in: who was there is told, and lost. The handler may close all lines in this call.
  void give_way(std::uint8_t by) {
    if (from()) line_->replace(by);
  }
  /// @param line outlives this
  void comes_by(InputLine& line) { line_ = &line; }

 private:
  InputLine* line_ = nullptr;
};

}  // namespace limb_ring::link
