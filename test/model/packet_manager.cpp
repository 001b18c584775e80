// The Packet Manager: protocol.md sections 2.4, 5.2 and 6.4.
#include <algorithm>

#include "model/node.h"

namespace limb_ring::model {

void Node::give(SliceKind kind, const Bytes& bytes) {
  fold_ ? fold_->send({kind, bytes}) : given[0].push_back({kind, bytes});
}

/// What waits for the output, what is going out, and what has gone out in this instant, is dropped. (protocol.md
/// section 2.6)
void Node::drop_output(Time now) {
  fold_ ? fold_->drop_sent() : given[0].clear();
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
  const bool waited_for_hello = !hello_left_;
  while (step_once(now)) {
    // On a line without a rate the hello has left as a whole; what it held up comes with the next run of this instant.
    if (waited_for_hello && hello_left_ && !outgoing_) return;
  }
}

/// The INTP that has waited longer; on a tie the own one.
Node::Next Node::next_interrupt(Time free) const {
  Next next;
  Time own_since_when = kNever;
  if (const auto since = own_since(interrupts_)) {
    own_since_when = *since;
    next = {std::max(*since, free), Next::own_intp};
  }
  if (relayed_interrupts_.empty()) return next;
  const RelayedInterrupt& first = relayed_interrupts_.front();
  const Time relayed_at = std::max(first.leaves_at, free);
  const bool waited_longer = next.at == relayed_at && first.since < own_since_when;
  if (next.at > relayed_at || waited_longer) next = {relayed_at, Next::relayed_intp};
  return next;
}

/// The DATP that has waited longer; on a tie the own one.
Node::Next Node::next_datp(Time free) const {
  const auto own = own_since(data_);
  const Time own_at = own ? std::max(free, *own) : kNever;
  const Time relayed_at = relayed_.empty() ? kNever : std::max(free, relayed_.front()->header_at);
  if (own && (own_at < relayed_at || (own_at == relayed_at && *own <= relayed_.front()->since)))
    return {own_at, Next::own_datp};
  return relayed_.empty() ? Next() : Next{relayed_at, Next::relayed_datp};
}

/// The end of the DATP that is going out.
Node::Next Node::next_end(Time free) const {
  const Outgoing& out = *outgoing_;
  if (out.relayed && out.relayed->broken) return {free, Next::abort};
  if (!out.complete()) return {};
  const int words = static_cast<int>((out.bytes().size() - 12) / 4);
  const Time words_left = out.header_left + (4 * words + static_cast<int>(12 * out.embedded)) * settings_.byte_time_out;
  const Time in = out.relayed ? out.relayed->end_at : Time{};
  return {std::max({words_left, free, in}), Next::tail};
}

/// An INTP is embedded at a word boundary, or before the tail if that is nearer.
Time Node::embedded_at(Time ready, const Next& end) const {
  const Outgoing& out = *outgoing_;
  const Duration word = 4 * settings_.byte_time_out;
  if (ready == kNever || word == Duration{0} || ready <= out.grid) return ready;
  const Time boundary = out.grid + (ready - out.grid + word - Duration{1}) / word * word;
  return end.what == Next::tail && ready <= end.at ? std::min(boundary, end.at) : boundary;
}

/// What goes next, and when, if nothing else comes.
Node::Next Node::next_step(Time now) const {
  if (!out_.up || !ready_[output_line()]) return {};
  const Time free = std::max(line_free_, now);
  Next intp = next_interrupt(free);
  const Next datp = outgoing_ ? next_end(free) : next_datp(free);
  if (outgoing_) intp.at = settings_.embed_interrupts ? embedded_at(intp.at, datp) : kNever;
  // On a line without a rate it leaves as a whole, also if its leaving allows an INTP, as into an open chain.
  if (outgoing_ && outgoing_->complete() && outgoing_->header_left == now && settings_.byte_time_out == Duration{0})
    return datp;
  return intp.at != kNever && intp.at <= datp.at ? intp : datp;
}

/// The whole words of the DATP on the line that have come in, and gone.
void Node::give_words(Time now) {
  Outgoing& out = *outgoing_;
  const Duration word = 4 * settings_.byte_time_out;
  std::size_t bytes = out.bytes().size() / 4 * 4;
  if (out.complete()) bytes = 4 + (out.bytes().size() - 12) / 4 * 4;
  if (word > Duration{0}) {
    const auto gone = (now - out.header_left) / word - 3 * static_cast<int>(out.embedded);
    bytes = std::min(bytes, 4 + 4 * static_cast<std::size_t>(gone));
  }
  if (bytes <= out.given) return;
  const auto begin = out.bytes().begin();
  give(SliceKind::more, Bytes(begin + static_cast<long>(out.given), begin + static_cast<long>(bytes)));
  out.given = bytes;
}

void Node::give_interrupt(bool own, Time now) {
  line_free_ = now + 12 * settings_.byte_time_out;
  if (outgoing_) {
    give_words(now);
    ++outgoing_->embedded;
    outgoing_->grid = line_free_;
  }
  if (own) return give(SliceKind::interrupt, launch(interrupts_, now).bytes);
  give(SliceKind::interrupt, relayed_interrupts_.front().bytes);
  relayed_interrupts_.pop_front();
}

void Node::give_start(bool own, Time now) {
  Outgoing out;
  if (own)
    out.own = launch(data_, now).bytes;
  else
    out.relayed = relayed_.front();
  out.header_left = out.grid = line_free_ = now + 4 * settings_.byte_time_out;
  out.given = settings_.byte_time_out == Duration{0} && !out.complete() ? out.bytes().size() : 4;
  give(SliceKind::start, Bytes(out.bytes().begin(), out.bytes().begin() + static_cast<long>(out.given)));
  outgoing_ = out;
}

void Node::give_end(SliceKind kind, Time now) {
  const Bytes& bytes = outgoing_->bytes();
  if (kind == SliceKind::end)
    line_free_ = now + static_cast<int>((bytes.size() - 12) % 4 + 8) * settings_.byte_time_out;
  give(kind,
       kind == SliceKind::end ? Bytes(bytes.begin() + static_cast<long>(outgoing_->given), bytes.end()) : Bytes());
  if (outgoing_->relayed) relayed_.pop_front();
  outgoing_.reset();
}

bool Node::step_once(Time now) {
  const Next next = next_step(now);
  if (next.what == Next::nothing || next.at > now) return false;
  if (next.what == Next::own_intp || next.what == Next::relayed_intp)
    give_interrupt(next.what == Next::own_intp, now);
  else if (next.what == Next::own_datp || next.what == Next::relayed_datp)
    give_start(next.what == Next::own_datp, now);
  else
    give_end(next.what == Next::tail ? SliceKind::end : SliceKind::abort, now);
  return true;
}

}  // namespace limb_ring::model
