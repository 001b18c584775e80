// The fold's lines and its time: protocol.md sections 8.7 to 8.9.
#include "model/fold_back.h"

#include <algorithm>
#include <sstream>

namespace limb_ring::model {

FoldBack::FoldBack(const core::Settings& settings, BehindFold& nc, Lines& given, Time now)
    : settings_(settings),
      nc_(nc),
      given_(given),
      period_(settings.beacon == Duration{0} ? Duration{std::chrono::milliseconds(100)} : settings.beacon),
      allowed_at_(now + settings.fold_permission),
      upstream_(core::node_after(settings.order, settings.id, settings.nodes() - 1)),
      downstream_(core::node_after(settings.order, settings.id, 1)) {}

unsigned FoldBack::lines_between(int from, int to) const {
  return static_cast<unsigned>(core::distance(settings_.order, wire::NodeId{static_cast<std::uint8_t>(from)},
                                              wire::NodeId{static_cast<std::uint8_t>(to)}));
}

bool FoldBack::lies_between(int node, int from, int to) const {
  const unsigned away = lines_between(from, node);
  return away > 0 && away < lines_between(from, to);
}

void FoldBack::say(Line line, FoldWordKind kind, int node) {
  const bool ends_stream = kind != FoldWordKind::deaf && kind != FoldWordKind::hears;
  if (line == Line::second && ends_stream) abort_repeated();  // these come between packets
  put_word(line, kind, node);
}

void FoldBack::put_word(Line line, FoldWordKind kind, int node) {
  const auto index = static_cast<std::size_t>(line);
  const auto word = static_cast<std::uint8_t>(kind), of = static_cast<std::uint8_t>(node);
  given_[index].push_back({wire::SliceKind::fold, {word, of, static_cast<std::uint8_t>(0xFF ^ word ^ of)}});
}

/// The NC's input and output as they are now. (protocol.md sections 8.9, 8.10)
void FoldBack::tell_nc(Time now) {
  BehindFold::Lines lines;
  lines.before = upstream_;
  lines.next = downstream_;
  lines.input_folded = takes_second() && fold_node_;
  lines.input_up = lines.input_folded || (!takes_second() && lines_[0].from);
  lines.output_folded = turned_back() && lines_[1].to && lines.input_up;
  lines.output_up = lines.output_folded || (!turned_back() && lines_[0].to);
  if (nc_output_ && !lines.output_up) abort_sent(turned_back() ? Line::second : Line::first);
  nc_output_ = lines.output_up;
  nc_.lines_are(lines, now);
}

// ---- lines ------------------------------------------------------------------------------------

void FoldBack::input_up(Line line, int from, Time now) {
  lines_[static_cast<std::size_t>(line)].from = from;
  if (line == Line::second) return decide_output(now);  // its DATP may just have ended
  upstream_ = from;
  input_ = Half::between;
  has_spoken_ = false;
  if (may_fold_) say(Line::second, FoldWordKind::hears, settings_.id);
  if (fold_node_ && lies_between(*fold_node_, from, settings_.id)) fold_node_.reset();
  if (!fold_node_) input_to_first(now);
  decide_output(now);
}

void FoldBack::input_lost(Line line, Time now) {
  Ends& ends = lines_[static_cast<std::size_t>(line)];
  if (!ends.from) return;
  ends.from.reset();
  if (line == Line::second) {
    forget_fold_node(now);
    return decide_output(now);
  }
  held_.clear();
  drained_at_ = kNever;
  if (open_on_first_) nc_.input_breaks(now);
  open_on_first_ = false;
  input_ = Half::second;
  say_again(now);
  decide_output(now);
}

void FoldBack::input_gap(Line line, Time now) {
  if (line == Line::second) return break_off_second(now);
  if (open_on_first_) nc_.input_breaks(now);
  open_on_first_ = false;
}

void FoldBack::output_up(Line line, int to, Time now) {
  lines_[static_cast<std::size_t>(line)].to = to;
  if (line == Line::first) {
    downstream_ = to;
    next_is_deaf_ = false;
    if (!turned_back()) say(Line::first, FoldWordKind::last, settings_.id);
  } else {
    open_repeated_ = false;
    if (repeats()) say(Line::second, FoldWordKind::begin, *fold_node_);
    say_again(now);
  }
  decide_output(now);
}

void FoldBack::output_lost(Line line, Time now) {
  Ends& ends = lines_[static_cast<std::size_t>(line)];
  if (!ends.to) return;
  ends.to.reset();
  if (line == Line::second && output_ == Half::between) {
    nc_.output_breaks(now);
    open_sent_ = false;
    output_to_first(now);
  }
  decide_output(now);
}

void FoldBack::receive(Line line, const Given& slice, Time now) {
  line == Line::first ? first_slice(slice, now) : second_slice(slice, now);
}

// ---- time -------------------------------------------------------------------------------------

/// What a node with a folded half says every beacon period.
void FoldBack::say_again(Time now) {
  again_at_ = folded() ? now + period_ : kNever;
  if (!may_fold_) return;
  if (input_ == Half::second) say(Line::second, FoldWordKind::deaf, settings_.id);
  if (input_ == Half::between) say(Line::second, FoldWordKind::hears, settings_.id);
  if (turned_back()) say_begin();
}

void FoldBack::run(Time now) { give_held(now); }

void FoldBack::timers(Time now) {
  if (!may_fold_ && allowed_at_ <= now) {
    may_fold_ = true;
    if (folded()) say_again(now);
    decide_output(now);
  }
  if (fold_node_ && fold_node_heard_ + 5 * period_ <= now) {
    forget_fold_node(now);
    decide_output(now);
  }
  if (drained_at_ <= now) {
    if (fold_node_ == lines_[0].from) fold_node_.reset();
    input_to_first(now);
    decide_output(now);
  }
  if (again_at_ <= now) say_again(now);
}

Time FoldBack::next_deadline() const {
  Time next = std::min(drained_at_, again_at_);
  if (!may_fold_) next = std::min(next, allowed_at_);
  if (fold_node_) next = std::min(next, fold_node_heard_ + 5 * period_);
  return next;
}

std::string FoldBack::in_words() const {
  static const char* const kHalf[] = {"first", "second", "draining or leaving"};
  std::ostringstream text;
  const auto id = [](const std::optional<int>& of) { return of ? std::to_string(*of) : std::string("nobody"); };
  for (const Ends& line : lines_) text << "line from " << id(line.from) << " to " << id(line.to) << ", ";
  text << "input half " << kHalf[static_cast<int>(input_)] << ", output half " << kHalf[static_cast<int>(output_)]
       << ", fold node " << id(fold_node_) << (next_is_deaf_ ? ", next is deaf" : "") << ", held " << held_.size();
  return text.str();
}

}  // namespace limb_ring::model
