// FoldBack's output half: the first line, or back onto the second. (ours, protocol.md section 8.10)
#include "core/fold/fold_back.h"

namespace limb_ring::core {

using wire::FoldWordKind;

// clang-format off
const FoldBack::OutRow FoldBack::kOutputTable[] = {
    // input                 from              to            first    then
    {OutInput::blocked,      in(Out::first),   Out::second,  nullptr, &FoldBack::turn_back},
    {OutInput::blocked,      in(Out::leaving), Out::second,  nullptr, nullptr},
    {OutInput::free,         in(Out::second),  Out::leaving, nullptr, nullptr},
    {OutInput::packet_ended, in(Out::leaving), Out::first,   nullptr, &FoldBack::turn_forward},
};
// clang-format on

void FoldBack::on(OutInput input, Time now) {
  const OutRow* row = find_row(kOutputTable, input, out_);
  if (row == nullptr) return;
  out_ = row->to;
  if (row->then) (this->*row->then)(now);
}

void FoldBack::settle_output(Time now) {
  const bool blocked = (!output_up_ && may_fold_) || next_is_deaf_;
  on(blocked ? OutInput::blocked : OutInput::free, now);
  if (out_ == Out::leaving && !second_output_up_ && told_output_) {
    given_out_.close();
    blocks_.output_replaced(now);
  }
  if (!blocks_.is_mid_packet()) on(OutInput::packet_ended, now);
  const bool up = out_ == Out::first ? output_up_ : second_output_up_ && told_input_;
  if (up == told_output_) return;
  told_output_ = up;
  if (up) return blocks_.output_up(to_, now, turned_back());
  break_off_output(turned_back() ? Line::second : Line::first);
  blocks_.output_lost(now);
  if (out_ == Out::leaving) settle_output(now);  // its DATP has ended with that
}

// Nothing of the DATP that the blocks are sending goes on. Who hears that line is told.
void FoldBack::break_off_output(Line line) {
  const bool up = line == Line::first ? output_up_ : second_output_up_;
  if (given_out_.is_open() && up) (line == Line::first ? first_ : second_).put(wire::SliceKind::abort, {});
  given_out_.close();
}

void FoldBack::turn_back(Time now) {
  ++counters_.folds;
  break_off_output(Line::first);
  if (told_output_) blocks_.output_replaced(now);
  say_words(now);
}

// Between two packets, so that none is lost.
void FoldBack::turn_forward(Time) {
  say(FoldWordKind::last, id());
  greet_next_node();
  if (fold_node_ && in_ == In::first) say(FoldWordKind::begin, *fold_node_);
}

// The next node waits for this before it takes the first line for its input.
void FoldBack::greet_next_node() {
  if (out_ == Out::first) wire::put(first_, {FoldWordKind::last, id()});
}

}  // namespace limb_ring::core
