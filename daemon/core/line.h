#pragma once

#include <cstddef>
#include <cstdint>

namespace limb_ring::core {

/// A line of the ring: the first, which every ring has, or the second of a ring that folds back, which runs against it.
enum class Line : std::uint8_t { first, second };

/// The lines that a ring has, for range-based for.
class Lines {
 public:
  explicit constexpr Lines(bool second) : count_(second ? 2 : 1) {}
  constexpr const Line* begin() const { return kAll; }
  constexpr const Line* end() const { return kAll + count_; }

 private:
  static constexpr Line kAll[] = {Line::first, Line::second};
  std::size_t count_;
};

}  // namespace limb_ring::core
