#include "core/transmit/send_unit.h"

#include <algorithm>

namespace limb_ring::core {

namespace {

void count_outcome(Counters& counters, Outcome outcome) {
  switch (outcome) {
    case Outcome::delivered:
      ++counters.ended_delivered;
      break;
    case Outcome::refused:
      ++counters.ended_refused;
      break;
    case Outcome::no_such_node:
      ++counters.ended_no_such_node;
      break;
    case Outcome::lost:
      ++counters.ended_lost;
      break;
    case Outcome::unconfirmed:
      ++counters.ended_unconfirmed;
      break;
    case Outcome::rejected:
      ++counters.ended_rejected;
      break;
    case Outcome::cancelled:
      ++counters.ended_cancelled;
      break;
  }
}

}  // namespace

void SendUnit::set_open_chain(bool open, Time now) {
  open_chain_ = open;
  if (open && busy()) end_outstanding(Outcome::unconfirmed, now);
}

wire::ByteView SendUnit::launch(Time now) {
  ++outstanding().end.tries;
  const wire::ByteView image = flight_.launch(now, settings_.send_timeout());
  if (open_chain_) end_outstanding(Outcome::unconfirmed, now);
  return image;
}

bool SendUnit::returned(const wire::PacketFields& packet, std::uint8_t fbc, bool doubtful, Time at) {
  if (!flight_.is_return(packet)) return false;
  count_return();
  if (doubtful && outstanding().end.owner != kController)
    give_up(at);
  else
    decide(fbc, at);
  return true;
}

// The FBC of one try says nothing about an earlier try, which may have been taken.
void SendUnit::decide(std::uint8_t fbc, Time at) {
  const Duration round_trip = at - flight_.sent_at();
  const bool sure = !outstanding().repeated;
  if (fbc == wire::kFbcUntaken) {
    numbers_.undecided(flight_.destination());
    return end_outstanding(sure ? Outcome::no_such_node : Outcome::lost, at, round_trip);
  }
  numbers_.decided(flight_.destination());
  if (fbc != 0) return end_outstanding(Outcome::delivered, at, round_trip);
  if (goes_again(at)) return;
  end_outstanding(sure ? Outcome::refused : Outcome::lost, at, round_trip);
}

void SendUnit::returned_damaged(Time at) {
  if (flight_.phase() == Flight::Phase::out) fail_try(at);
}

void SendUnit::fail_try(Time at) {
  Send& send = outstanding();
  send.repeated = true;
  const Time until = retry_until(send, at);
  if (!send.told && !send.forgotten && at < until && flight_.retry(at, until)) return;
  give_up(at);
}

// Where the ring falls into parts, its receiver may start while this node is cut off, and hear it again later: by then
// the tries must be over. (ours, protocol.md section 4.10)
Time SendUnit::retry_until(const Send& send, Time at) const {
  const Time until = at + settings_.queue_timeout;
  const bool may_be_taken_twice = settings_.falls_into_parts() && send.end.owner != kController;
  return may_be_taken_twice ? std::min(until, flight_.first_sent_at() + settings_.tries_last()) : until;
}

void SendUnit::give_up(Time at) {
  numbers_.undecided(flight_.destination());
  end_outstanding(Outcome::lost, at);
}

void SendUnit::handle_try_timeout(Time now) {
  if (flight_.deadline() > now) return;
  if (flight_.phase() == Flight::Phase::waiting) return give_up(now);
  ++counters_.timeouts;
  fail_try(now);
}

void SendUnit::end_outstanding(Outcome outcome, Time at, Duration round_trip) {
  flight_.clear();
  free_at_ = at;
  tell(outstanding(), outcome, at, round_trip);
  pop_outstanding();
}

void SendUnit::tell(Send& send, Outcome outcome, Time at, Duration round_trip) {
  if (send.told) return;
  send.told = true;
  send.end.outcome = outcome;
  send.end.reject = outcome == Outcome::rejected ? Reject::no_way_out : Reject::none;
  send.end.round_trip = round_trip;
  give_out(send.end, at);
}

void SendUnit::give_out(const SendEnded& ended, Time at) {
  count_outcome(counters_, ended.outcome);
  events_.put(at, ended);
}

void SendUnit::forgotten_by(NodeId peer, Time now) {
  if (flight_.idle() || outstanding().end.owner == kController) return;
  const NodeId destination = outstanding().end.destination;
  if (destination != peer && destination != wire::kBroadcast) return;
  outstanding().forgotten = true;
  if (flight_.phase() == Flight::Phase::waiting && outstanding().repeated) give_up(now);
}

std::uint8_t* Flight::load(wire::Code code, wire::NodeId source, wire::NodeId destination, std::uint8_t last,
                           std::size_t data_size) {
  code_ = code;
  size_ = data_size + wire::kOverhead;
  (*bytes_)[wire::field::kSop] = wire::kSop;
  (*bytes_)[wire::field::kHop] = 0;
  (*bytes_)[wire::field::kSource] = source;
  std::uint8_t* end = bytes_->data() + size_;
  *(end - wire::field::kEopFromEnd) = wire::kEop;
  *(end - wire::field::kFbcFromEnd) = wire::kFbcUntaken;
  *(end - wire::field::kDestinationFromEnd) = destination;
  *(end - wire::field::kLastFromEnd) = last;
  return bytes_->data() + wire::kHeaderSize;
}

wire::ByteView Flight::launch(Time now, Duration timeout) {
  (*bytes_)[wire::field::kCode] = code_.byte();
  const std::size_t covered = size_ - wire::kCrcSize;
  wire::store_u32(bytes_->data() + covered, wire::crc32({bytes_->data(), covered}));
  phase_ = Phase::out;
  since_ = sent_at_ = now;
  if (code_.attempt == 0) first_sent_at_ = now;
  deadline_ = now + timeout;
  return image();
}

bool Flight::is_return(const wire::PacketFields& packet) const {
  const wire::PacketFields sent{image()};
  if (idle() || packet.bytes.size != size_ || packet.code_byte() != sent.code_byte()) return false;
  const std::uint32_t as_sent = wire::carried_crc(packet.crc(), size_, packet.hop(), packet.fbc() ^ wire::kFbcUntaken);
  return packet.destination() == sent.destination() && packet.last() == sent.last() && as_sent == sent.crc();
}

bool Flight::retry(Time now, Time until) {
  if (code_.attempt == wire::kTries - 1) return false;
  ++code_.attempt;
  phase_ = Phase::waiting;
  since_ = now;
  deadline_ = until;
  return true;
}

}  // namespace limb_ring::core
