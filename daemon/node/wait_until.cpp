#include "node/wait_until.h"

#include <boost/asio/steady_timer.hpp>
#include <memory>

namespace limb_ring::runtime {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLookEvery{2};

struct Wait : std::enable_shared_from_this<Wait> {
  Wait(boost::asio::io_context& io, std::weak_ptr<void> whose, std::function<bool()> what, steady_clock::time_point end,
       std::function<void(bool)> tell)
      : owner(std::move(whose)), condition(std::move(what)), deadline(end), done(std::move(tell)), timer(io) {}

  void poll() {
    if (owner.expired()) return;
    if (condition()) return done(true);
    if (steady_clock::now() >= deadline) return done(false);
    timer.expires_after(kLookEvery);
    timer.async_wait([self = shared_from_this()](const auto& error) {
      if (!error) self->poll();
    });
  }

  std::weak_ptr<void> owner;
  std::function<bool()> condition;
  steady_clock::time_point deadline;
  std::function<void(bool)> done;
  boost::asio::steady_timer timer;
};

}  // namespace

void wait_until(boost::asio::io_context& io, const std::shared_ptr<void>& owner, std::function<bool()> condition,
                std::chrono::milliseconds patience, std::function<void(bool)> done) {
  std::make_shared<Wait>(io, owner, std::move(condition), steady_clock::now() + patience, std::move(done))->poll();
}

}  // namespace limb_ring::runtime
