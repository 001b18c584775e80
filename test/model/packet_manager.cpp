// The Packet Manager: protocol.md sections 2.4, 5.2 and 6.4.
#include <algorithm>

#include "model/node.h"

namespace limb_ring::model {

void Node::give(SliceKind kind, const Bytes& bytes) { given[0].push_back({kind, bytes}); }

/// What waits for the output, and what is going out, is dropped. (protocol.md section 2.6)
void Node::drop_output(Time now) {
  relayed_.clear();
  relayed_interrupts_.clear();
  outgoing_.reset();
  line_free_ = now;
  if (incoming_ && incoming_->relayed) {
    incoming_->relayed.reset();
    incoming_->fate = Incoming::Fate::received_only;
  }
}

void Node::step(Time now) {
  while (step_once(now)) {
  }
}

/// What goes next, and when, if nothing else comes.
Node::Next Node::next_step(Time now) const {
  Next next;
  if (!out_.up || !ready_[0]) return next;
  const Duration byte = settings_.byte_time_out;
  const Time free = std::max(line_free_, now);

  // The INTP that has waited longer; on a tie the own one.
  Time intp = kNever, intp_since = kNever;
  if (const auto since = own_since(interrupts_)) intp = intp_since = *since;
  bool own_intp = intp != kNever;
  if (!relayed_interrupts_.empty()) {
    const RelayedInterrupt& first = relayed_interrupts_.front();
    const Time own_at = std::max(intp, free), relayed_at = std::max(first.leaves_at, free);
    if (!own_intp || (own_at > relayed_at) || (own_at == relayed_at && first.since < intp_since)) {
      own_intp = false;
      intp = first.leaves_at;
    }
  }
  intp = intp == kNever ? kNever : std::max(intp, free);

  Time datp = kNever;
  if (outgoing_) {
    const Outgoing& out = *outgoing_;
    const Bytes& bytes = out.bytes();
    if (out.relayed && out.relayed->broken) {
      datp = std::max(free, now);
      next.what = Next::abort;
    } else if (out.complete()) {
      const int words = static_cast<int>((bytes.size() - 12) / 4);
      datp = out.header_left + 4 * words * byte + static_cast<int>(12 * out.embedded) * byte;
      datp = std::max(datp, free);
      if (out.relayed) datp = std::max(datp, out.relayed->end_at);
      next.what = Next::tail;
    }
    if (intp != kNever && settings_.embed_interrupts) {  // at a word boundary, or before the tail if that is nearer
      if (byte > Duration{0} && intp > out.grid) {
        const auto words = (intp - out.grid + 4 * byte - Duration{1}) / (4 * byte);
        Time boundary = out.grid + words * 4 * byte;
        if (next.what == Next::tail && intp <= datp) boundary = std::min(boundary, std::max(intp, datp));
        intp = boundary;
      }
    } else {
      intp = kNever;
    }
  } else {
    Time own = kNever, relayed = kNever;
    if (const auto since = own_since(data_)) own = *since;
    if (!relayed_.empty()) relayed = std::max(free, relayed_.front()->header_at);
    const Time own_at = own == kNever ? kNever : std::max(free, own);
    if (own_at < relayed || (own_at == relayed && own != kNever && own <= relayed_.front()->since)) {
      datp = own_at;
      next.what = Next::own_datp;
    } else if (relayed != kNever) {
      datp = relayed;
      next.what = Next::relayed_datp;
    }
  }
  next.at = datp;
  if (intp != kNever && intp <= datp) {
    next.at = intp;
    next.what = own_intp ? Next::own_intp : Next::relayed_intp;
  }
  return next;
}

bool Node::step_once(Time now) {
  const Next next = next_step(now);
  if (next.what == Next::nothing || next.at > now) return false;
  const int byte_of[] = {4, 12};
  const Duration byte = settings_.byte_time_out;
  switch (next.what) {
    case Next::own_intp:
    case Next::relayed_intp: {
      Bytes intp;
      if (outgoing_) {  // the whole words that have come in, and gone
        Outgoing& out = *outgoing_;
        std::size_t words = out.bytes().size() / 4 * 4;
        if (out.complete()) words = 4 + (out.bytes().size() - 12) / 4 * 4;
        if (byte > Duration{0}) {
          const auto gone = (now - out.header_left) / (4 * byte) - 3 * static_cast<int>(out.embedded);
          words = std::min(words, 4 + 4 * static_cast<std::size_t>(gone));
        }
        if (words > out.given)
          give(SliceKind::more, Bytes(out.bytes().begin() + static_cast<long>(out.given),
                                      out.bytes().begin() + static_cast<long>(words)));
        out.given = std::max(out.given, words);
        ++out.embedded;
        out.grid = now + byte_of[1] * byte;
      }
      if (next.what == Next::own_intp) {
        intp = launch(interrupts_, now).bytes;
      } else {
        intp = relayed_interrupts_.front().bytes;
        relayed_interrupts_.pop_front();
      }
      give(SliceKind::interrupt, intp);
      line_free_ = now + byte_of[1] * byte;
      return true;
    }
    case Next::own_datp:
    case Next::relayed_datp: {
      Outgoing out;
      if (next.what == Next::own_datp) {
        out.own = launch(data_, now).bytes;
      } else {
        out.relayed = relayed_.front();
      }
      out.header_left = out.grid = line_free_ = now + byte_of[0] * byte;
      out.given = 4;
      if (byte == Duration{0} && !out.complete()) out.given = out.bytes().size();
      give(SliceKind::start, Bytes(out.bytes().begin(), out.bytes().begin() + static_cast<long>(out.given)));
      outgoing_ = out;
      return true;
    }
    case Next::tail: {
      const Bytes& bytes = outgoing_->bytes();
      give(SliceKind::end, Bytes(bytes.begin() + static_cast<long>(outgoing_->given), bytes.end()));
      line_free_ = now + static_cast<int>((bytes.size() - 12) % 4 + 8) * byte;
      if (outgoing_->relayed) relayed_.pop_front();
      outgoing_.reset();
      return true;
    }
    case Next::abort:
      give(SliceKind::abort, {});
      relayed_.pop_front();
      outgoing_.reset();
      return true;
    case Next::nothing:
      break;
  }
  return false;
}

}  // namespace limb_ring::model
