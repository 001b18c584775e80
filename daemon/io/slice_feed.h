#pragma once

#include <cstdint>
#include <vector>

#include "io/input_handler.h"
#include "io/link_counters.h"

namespace limb_ring::link {

/// Hands on the slices of a byte stream: all of one read, then the end of the batch. Idle slices
/// end here. A slice that is not all there yet waits for the next read.
class SliceFeed {
 public:
  /// What one read takes at most. Taking all that has come in one read is what keeps a loaded
  /// ring fast.
  static constexpr std::size_t kReadSize = 64 * 1024;

  SliceFeed() : buffer_(kReadSize + wire::kMaxSliceSize) {}

  std::uint8_t* space() { return buffer_.data() + kept_; }
  std::size_t space_size() const { return buffer_.size() - kept_; }

  /// `size` bytes were put into space(). @return false: they are no slices.
  bool commit(std::size_t size, InputHandler& handler, InputCounters& counters);
  /// From within a call of the handler: hand on nothing more.
  void stop() { stopped_ = true; }

 private:
  std::vector<std::uint8_t> buffer_;
  std::size_t kept_ = 0;
  bool stopped_ = false;
};

}  // namespace limb_ring::link
