#include "node/babbling_cpu.h"

#include "node/rejected_pause.h"
#include "node/send_owner.h"

namespace limb_ring::runtime {
namespace {

constexpr core::Owner kBabblingOwner = SendOwner::of(SendOwner::Kind::babbling_cpu).to_core();

}  // namespace

void BabblingCpu::start(std::chrono::nanoseconds period) {
  stop();
  period_ = period;
  on_ = true;
  first_token_ = next_token_;
  sent_ = 0;
  // One goes onto the ring, the others fill the queue, and the last is rejected: the queue is full from the start.
  const unsigned at_once = period.count() == 0 ? driver_.controller().settings().send_queue + 2 : 1;
  for (unsigned i = 0; i < at_once; ++i) send();
  driver_.pump();
}

void BabblingCpu::stop() {
  if (!on_) return;
  on_ = false;
  next_->cancel();
  driver_.controller().cancel(kBabblingOwner, driver_.now());
  driver_.pump();
}

void BabblingCpu::send() {
  wire::store_u32(data_.data(), next_token_);  // no two alike
  core::SendRequest request;                   // of the highest priority, to all
  request.owner = kBabblingOwner;
  request.token = next_token_++;
  request.destination = wire::kBroadcast;
  request.data = {data_.data(), data_.size()};
  driver_.controller().send(request, driver_.now());
}

void BabblingCpu::send_next() {
  if (!on_) return;
  send();
  driver_.pump();
}

void BabblingCpu::on_ended(const core::SendEnded& ended) {
  if (!on_ || ended.token - first_token_ >= next_token_ - first_token_) return;  // of an earlier run
  ++sent_;
  const auto pause = pause_after(ended.outcome, period_);
  if (pause.count() > 0) return next_->expires_at(driver_.clock().now() + pause);
  send();
}

}  // namespace limb_ring::runtime
