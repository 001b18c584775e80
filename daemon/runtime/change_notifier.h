#pragma once

#include <cstdint>

#include "runtime/engine.h"
#include "runtime/observers.h"

namespace limb_ring::runtime {

/// What the observers were last told of figures that change without an event of their own: the size of the
/// ring, and packets that came in damaged or were damaged on purpose. (ours)
class ChangeNotifier {
 public:
  /// Tells what is no longer as it was the last time.
  void look(const Engine& engine, Observers& observers);

 private:
  unsigned ring_size_ = 0;
  std::uint64_t crc_errors_ = 0;
  std::uint64_t line_corrupted_ = 0;
};

}  // namespace limb_ring::runtime
