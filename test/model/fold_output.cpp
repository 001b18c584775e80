// The output half of the fold: protocol.md section 8.10.
#include "model/fold_back.h"

namespace limb_ring::model {

void FoldBack::decide_output(Time now) {
  if (!may_fold_ && lines_[0].from && lines_[0].to) {
    may_fold_ = true;
    if (folded()) say_again(now);
  }
  const bool back = (!lines_[0].to && may_fold_) || next_is_deaf_;
  if (back && output_ == Half::first) {
    output_ = Half::second;
    sent_.clear();
    abort_sent(Line::first);
    say_again(now);
  } else if (back) {
    output_ = Half::second;
  } else if (output_ == Half::second) {
    output_ = Half::between;
  }
  end_leaving(now);
  tell_nc(now);
  if (end_leaving(now)) tell_nc(now);  // the DATP has ended with the NC's output
  if (!repeats()) abort_repeated();
  if (!folded()) again_at_ = kNever;
  if (folded() && again_at_ == kNever) again_at_ = now + period_;
}

bool FoldBack::end_leaving(Time now) {
  if (output_ != Half::between || nc_.is_mid_packet() || !sent_.empty()) return false;
  output_to_first(now);
  return true;
}

void FoldBack::say_begin() {
  if (next_is_deaf_ && lines_[0].to) say(Line::first, FoldWordKind::begin, settings_.id);
  say(Line::second, FoldWordKind::begin, settings_.id);
}

void FoldBack::output_to_first(Time) {
  output_ = Half::first;
  for (const Line line : {Line::second, Line::first}) say(line, FoldWordKind::last, settings_.id);
  if (repeats()) say(Line::second, FoldWordKind::begin, *fold_node_);
}

/// What has begun on that line is not finished on it. (protocol.md section 6.3)
void FoldBack::abort_sent(Line line) {
  const auto index = static_cast<std::size_t>(line);
  if (open_sent_ && lines_[index].to) given_[index].push_back({wire::SliceKind::abort, {}});
  open_sent_ = false;
}

void FoldBack::put_onto_line() {
  for (const Given& slice : sent_) {
    if (slice.kind == wire::SliceKind::start) open_sent_ = true;
    if (slice.kind == wire::SliceKind::end || slice.kind == wire::SliceKind::abort) open_sent_ = false;
  }
  auto& line = given_[turned_back() ? 1 : 0];
  line.insert(line.end(), sent_.begin(), sent_.end());
  sent_.clear();
}

void FoldBack::carry(Time now) {
  put_onto_line();
  if (output_ == Half::between && !nc_.is_mid_packet()) decide_output(now);
}

}  // namespace limb_ring::model
