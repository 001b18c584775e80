#pragma once

#include <sys/mman.h>

#include <cerrno>
#include <cstddef>
#include <new>
#include <system_error>

namespace limb_ring::bench {

/// `count` values of T in memory that this process shares with those it forks.
template <typename T>
class Shared {
 public:
  explicit Shared(std::size_t count) : count_(count) {
    memory_ = ::mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory_ == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "shared memory");
    for (std::size_t i = 0; i < count; ++i) new (begin() + i) T();
  }
  ~Shared() { ::munmap(memory_, bytes()); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;

  T& operator[](std::size_t index) { return begin()[index]; }
  T* begin() { return static_cast<T*>(memory_); }
  T* end() { return begin() + count_; }

 private:
  std::size_t bytes() const { return count_ * sizeof(T); }
  std::size_t count_;
  void* memory_;
};

}  // namespace limb_ring::bench
