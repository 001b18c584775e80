#pragma once

#include <sys/epoll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

namespace limb_ring::test {

/// While it lives, the kernel watches no more than a few further descriptors: fs.epoll.max_user_watches is reached. To
/// be included in one file of a test program, for which it takes the place of epoll_ctl().
class RefusedWatches {
 public:
  explicit RefusedWatches(unsigned but_for = 0) : left_(but_for) { now_ = this; }
  ~RefusedWatches() { now_ = nullptr; }
  RefusedWatches(const RefusedWatches&) = delete;
  RefusedWatches& operator=(const RefusedWatches&) = delete;

  /// One more is asked for.
  static bool refuses() {
    if (!now_ || now_->left_ == 0) return now_ != nullptr;
    --now_->left_;
    return false;
  }

 private:
  inline static RefusedWatches* now_ = nullptr;
  unsigned left_;
};

}  // namespace limb_ring::test

extern "C" int epoll_ctl(int set, int operation, int descriptor, epoll_event* event) noexcept {
  if (operation == EPOLL_CTL_ADD && limb_ring::test::RefusedWatches::refuses()) {
    errno = ENOSPC;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_epoll_ctl, set, operation, descriptor, event));
}
