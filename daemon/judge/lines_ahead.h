#pragma once

#include <cstddef>
#include <cstdint>

namespace limb_ring::recorder {

/// Fetches the memory that is written next into the caches. A recorder comes around to memory that is in none of them:
/// without this, each line that it writes waits for its old bytes. (ours)
class LinesAhead {
 public:
  /// Nothing was fetched behind `written`.
  explicit LinesAhead(const std::uint8_t* written) : fetched_(written) {}
  /// @param written up to there, and not less than before
  /// @param left bytes that may be written behind it
  void fetch(const std::uint8_t* written, std::size_t left) {
    if (left < kAhead) return;
    for (const std::uint8_t* const end = written + kAhead; fetched_ < end; fetched_ += kLine)
      __builtin_prefetch(fetched_, 1);
  }

 private:
  static constexpr std::size_t kAhead = 2048;  ///< bytes: some packets, as memory takes a while
  static constexpr std::size_t kLine = 64;     ///< bytes of a line; if they are more, it is fetched twice

  const std::uint8_t* fetched_;
};

}  // namespace limb_ring::recorder
