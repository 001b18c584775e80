#include "tools/ringctl/progress.h"

#include <future>
#include <utility>

#include "limb_ring/host_port.h"
#include "tools/ringctl/ring_clock.h"
#include "tools/ringctl/tell_user.h"

namespace limb_ring::ringctl {

namespace {
constexpr std::chrono::seconds kEvery{2};
constexpr std::chrono::milliseconds kWorkTick{200};
}  // namespace

Progress::Progress(std::string ring) : ring_(std::move(ring)), next_(std::chrono::steady_clock::now() + kEvery) {}

void Progress::tell(const std::string& what) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + kEvery;
  const std::string standing = ring_.empty() ? "" : standing_clock(ring_);
  if (!standing.empty())
    tell_user("waiting: " + standing);
  else if (!what.empty())
    tell_user(what + " ...");
}

void while_telling(const std::string& ring, const std::function<void()>& work, const std::string& what) {
  Progress progress(ring);
  std::future<void> done = std::async(std::launch::async, work);
  while (done.wait_for(kWorkTick) != std::future_status::ready) progress.tell(what);
  try {
    done.get();
  } catch (const HostPortTimeout&) {
    require_clock_goes(ring);
    throw;
  }
}

}  // namespace limb_ring::ringctl
