// The input half of the fold: protocol.md section 8.9.
#include <algorithm>

#include "model/fold_back.h"

namespace limb_ring::model {

namespace {

constexpr std::size_t kMostHeld = 64 * 1024;

bool begins(const Given& slice) { return slice.kind == wire::SliceKind::start; }
bool ends(const Given& slice) {
  return slice.kind == wire::SliceKind::end || slice.kind == wire::SliceKind::abort ||
         slice.kind == wire::SliceKind::whole;
}

}  // namespace

void FoldBack::first_slice(const Given& slice, Time now) {
  if (slice.kind == wire::SliceKind::fold) {
    const auto word = wire::fold_word({slice.kind, {slice.bytes.data(), slice.bytes.size()}});
    const bool asks = word && word->kind == FoldWordKind::begin;
    if (asks && input_ == Half::first && word->node == upstream_) say(Line::second, FoldWordKind::hears, settings_.id);
    if (asks || input_ != Half::between) return;
    has_spoken_ = true;
    drain(now);
    return decide_output(now);
  }
  if (input_ == Half::second) return;
  if (input_ == Half::first) {
    if (held_.empty()) return to_nc(slice, now);
    held_.push_back(slice);
    return give_held(now);
  }
  has_spoken_ = true;
  hold(slice, now);
  drain(now);
  decide_output(now);
}

void FoldBack::hold(const Given& slice, Time now) {
  held_.push_back(slice);
  std::size_t bytes = 0;
  for (const Given& one : held_) bytes += one.bytes.size() + 4;
  if (bytes <= kMostHeld) return;
  held_.clear();
  nc_.input_breaks(now);
}

/// The first line is back and has spoken: it is taken once the second is through.
void FoldBack::drain(Time now) {
  if (input_ != Half::between || !has_spoken_) return;
  if (!fold_node_ || (fold_node_ != lines_[0].from && !open_on_second_)) return input_to_first(now);
  const Duration timeout =
      std::max(settings_.send_timeout_least, 2 * (settings_.worst_lap() + settings_.second_line_lap()));
  if (drained_at_ == kNever) drained_at_ = now + std::min(settings_.stall, timeout / 8);
}

void FoldBack::input_to_first(Time now) {
  input_ = Half::first;
  drained_at_ = kNever;
  if (open_on_second_) nc_.input_breaks(now);
  open_on_second_ = false;
  if (repeats()) say(Line::second, FoldWordKind::begin, *fold_node_);
  tell_nc(now);
  give_held(now);
}

/// What was held, and what came behind it, as fast as the insertion buffer takes it.
void FoldBack::give_held(Time now) {
  while (input_ == Half::first && !held_.empty() && nc_.takes(held_.front())) {
    const Given slice = held_.front();
    held_.pop_front();
    to_nc(slice, now);
  }
}

void FoldBack::to_nc(const Given& slice, Time now) {
  if (begins(slice)) open_on_first_ = true;
  if (ends(slice)) open_on_first_ = false;
  nc_.slice_comes(slice, now);
}

}  // namespace limb_ring::model
