#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace limb_ring::core {

/// A queue that reuses its slots: packets are large, and one allocation for each would cost more than
/// the rest of its way through a node. It grows without a limit; its user sets one.
template <class T>
class SlotQueue {
 public:
  using value_type = T;
  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  /// @pre i < size(); 0 is the front
  T& operator[](std::size_t i) { return slots_[(first_ + i) & mask_]; }
  T& front() { return (*this)[0]; }
  const T& front() const { return slots_[first_]; }
  /// A new last slot, in whatever state its last user left it.
  T& push() {
    if (count_ == slots_.size()) grow();
    return (*this)[count_++];
  }
  void pop() {
    --count_;
    first_ = count_ == 0 ? 0 : (first_ + 1) & mask_;  // empty: reuse slot 0, still in cache
  }
  void pop_back() { --count_; }
  void clear() { count_ = 0; }
  /// Removes the elements from index `from` on for which which(T&) is true; the others keep their order.
  template <class Which>
  void erase_if(std::size_t from, Which which) {
    std::size_t kept = from;
    for (std::size_t i = from; i < count_; ++i) {
      if (which((*this)[i])) continue;
      if (kept != i) std::swap((*this)[kept], (*this)[i]);
      ++kept;
    }
    count_ = kept < count_ ? kept : count_;
  }

 private:
  void grow() {
    std::vector<T> larger(slots_.empty() ? 2 : 2 * slots_.size());
    for (std::size_t i = 0; i < count_; ++i) std::swap(larger[i], (*this)[i]);
    slots_.swap(larger);
    mask_ = slots_.size() - 1;
    first_ = 0;
  }

  std::vector<T> slots_;  ///< none, or a power of two
  std::size_t mask_ = 0;  ///< slots_.size() - 1: to divide by the size of a T with each access would be slow
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace limb_ring::core
