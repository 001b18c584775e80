#include "judge/sent_judge.h"

#include <algorithm>

namespace limb_ring::sim {

using core::Outcome;
using core::Reject;

namespace {

bool is_taken(int fbc) { return fbc > 0 && fbc != wire::kFbcUntaken; }

}  // namespace

const char* ResultJudge::objection() const {
  if (sent_.in_doubt) return nullptr;
  if (sent_.ended_at > due()) return ", so late";
  // A break heard, or a damaged return, ends a send as its last part comes, and is told with the last bit of that.
  const bool told_later = sent_.end.outcome == Outcome::unconfirmed || sent_.end.outcome == Outcome::lost;
  const core::Duration told = told_later ? told_within(settings_) : core::Duration{0};
  const bool reset = sent_.cancel_due != core::kNever && sent_.ended_at > sent_.cancel_due + told && !home();
  if (reset && sent_.end.outcome != Outcome::cancelled) return ", and it had been cancelled before";
  switch (sent_.end.outcome) {
    case Outcome::delivered:
      return against_delivered();
    case Outcome::refused:
      return against_refused();
    case Outcome::no_such_node:
      return against_no_such_node();
    case Outcome::lost:
      return against_lost();
    case Outcome::unconfirmed:
      return against_unconfirmed();
    case Outcome::rejected:
      return against_rejected();
    case Outcome::cancelled:
      return nullptr;  // a node that starts over shows that state after it
  }
  return nullptr;
}

// Four tries, each of which may wait for the line, behind four of the send before it.
Time ResultJudge::due() const {
  const core::Duration tries = wire::kTries * (settings_.send_timeout() + settings_.queue_timeout);
  return std::max(sent_.asked + settings_.queue_timeout + 2 * tries, source_.thawed);
}

// What is out to a node that has forgotten what it took is not repeated from then on. (protocol.md section 4.10)
bool ResultJudge::receiver_forgot() const {
  return sent_.forgotten_at != core::kNever && sent_.last_try <= sent_.forgotten_at;
}

// Where the ring falls into parts, no retry leaves later than that. (protocol.md section 4.3)
bool ResultJudge::tries_are_over() const {
  return settings_.falls_into_parts() && sent_.ended_at >= sent_.first_try + settings_.tries_last();
}

const char* ResultJudge::against_delivered() const {
  if (!home() && !sent_.clock_stood) return ", and it did not come home then";
  return is_taken(sent_.home_fbc) ? nullptr : ", and it came home untaken";
}

const char* ResultJudge::against_refused() const {
  if (sent_.repeated) return ", and some try had been repeated";
  const bool came_refused = (home() || sent_.clock_stood) && sent_.home_fbc == 0;
  if (sent_.interrupt() || sent_.destination == wire::kBroadcast)
    return came_refused ? nullptr : ", and it did not come home refused";
  if (sent_.first_refused == core::kNever) return ", and it never came home refused";
  if (overdue()) return nullptr;
  if (!came_refused) return ", and it did not come home refused then";
  return sent_.ended_at >= sent_.first_refused + settings_.refused_for ? nullptr : ", and it was to go again";
}

const char* ResultJudge::against_no_such_node() const {
  if (!home() && !sent_.clock_stood) return ", and it did not come home then";
  if (sent_.home_fbc != wire::kFbcUntaken) return ", and somebody had answered";
  return sent_.repeated ? ", and some try had been repeated" : nullptr;
}

const char* ResultJudge::against_lost() const {
  if (settings_.falls_into_parts() && home()) return nullptr;  // two parts may have grown together
  if (home() && is_taken(sent_.home_fbc)) return ", and it came home taken";
  if (receiver_forgot() || overdue()) return nullptr;
  // A try that comes home late has failed, also if its retry has not left yet. (protocol.md sections 4.2 and 4.6)
  const bool late = sent_.ended_at - sent_.last_try >= settings_.send_timeout();
  if (home()) return sent_.repeated || sent_.may_have_failed || late ? nullptr : ", and its first try came home";
  return sent_.attempts == wire::kTries || tries_are_over() ? nullptr : ", and it had tries left";
}

const char* ResultJudge::against_unconfirmed() const {
  return ring_was_broken_ ? nullptr : ", and no line was ever broken";  // its node has to show the open chain
}

const char* ResultJudge::against_rejected() const {
  if (sent_.tries != 0) return ", and it was on the line";
  switch (sent_.end.reject) {
    case Reject::queue_full:
      return sent_.queue_shared || sent_.ahead >= settings_.send_queue ? nullptr : ", and the queue had room";
    case Reject::no_way_out:
      return overdue() ? nullptr : ", and its time was not over";
    case Reject::bad_destination:
      return core::is_in(settings_.order, sent_.destination) || sent_.destination == wire::kBroadcast
                 ? ", and there is such a node"
                 : nullptr;
    case Reject::bad_size:
      return sent_.size >= 1 && sent_.size <= wire::kMaxPayload ? ", and its size is right" : nullptr;
    default:
      return nullptr;
  }
}

void DuePins::put(wire::NodeId source, wire::Factor factor, core::Time at, bool sure) {
  due_.push_back({source, factor, at, sure});
}

void DuePins::pulled(const core::PinPulled& pin, core::Time at) {
  const auto is_it = [&](const Due& due) {
    return due.source == pin.source && due.factor == pin.factor && due.at == at;
  };
  // Two may be due in one instant. The pull is that of the one which must be there.
  const auto is_surely_it = [&](const Due& due) { return due.sure && is_it(due); };
  auto it = std::find_if(due_.begin(), due_.end(), is_surely_it);
  if (it == due_.end()) it = std::find_if(due_.begin(), due_.end(), is_it);
  if (it != due_.end()) return static_cast<void>(due_.erase(it));
  complain_(Promise::exactly_once, node_words(node_) + " pulled pin " + std::to_string(pin.factor) + " for " +
                                       node_words(pin.source) + ", and no new INTP had come in that says so");
}

void DuePins::drop_before(core::Time now) {
  for (; !due_.empty() && due_.front().at < now; due_.pop_front())
    if (due_.front().sure)
      complain_(Promise::exactly_once, node_words(node_) + " did not pull pin " + std::to_string(due_.front().factor) +
                                           " for an INTP of " + node_words(due_.front().source));
}

}  // namespace limb_ring::sim
