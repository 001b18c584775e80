#include "io/successor.h"

namespace limb_ring::link {

Successor::Successor(std::size_t candidates, const Timing& timing, Time now)
    : timing_(timing), candidates_(candidates), patience_(now + timing.first_successor) {}

std::optional<std::size_t> Successor::next(Time now) {
  const std::size_t count = current_ ? *current_ : farthest(now) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    if (candidates_[i].state == Candidate::State::trying || candidates_[i].since > now) continue;
    set(i, Candidate::State::trying, now, candidates_[i].missing);
    return i;
  }
  return {};
}

void Successor::absent(std::size_t candidate, Time now) {
  if (candidate == 0) first_busy_since_.reset();
  set(candidate, Candidate::State::absent, now + timing_.candidate_retry(candidates_.size()), true);
}

void Successor::busy(std::size_t candidate, Time now) {
  if (candidate == 0) first_busy_since_.reset();
  set(candidate, Candidate::State::busy, now + timing_.candidate_retry(candidates_.size()));
}

bool Successor::says_busy(std::size_t candidate, Time now) {
  const Time since = candidate == 0 ? first_busy_since_.value_or(now) : now;
  const bool believed = now - since < kBelieved;
  believed ? busy(candidate, now) : absent(candidate, now);
  if (candidate == 0) first_busy_since_ = since;
  return believed;
}

void Successor::accepted(std::size_t candidate, Time now) {
  for (std::size_t i = candidate; i < candidates_.size(); ++i) candidates_[i] = {};
  if (candidate == 0) first_busy_since_.reset();
  current_ = candidate;
  up_since_ = now;
  patience_.reset();
}

void Successor::lost(Loss loss, Time now) {
  if (!current_) return;
  const std::size_t old = *current_;
  current_.reset();
  for (Candidate& c : candidates_) {
    if (c.state != Candidate::State::trying) c.since = now;
  }
  if (loss == Loss::replaced) {
    busy(old, now);
  } else if (loss == Loss::silent) {
    set(old, Candidate::State::absent, now, true);  // passed over at once, and tried beside the others
  } else if (now - up_since_ < timing_.retry) {
    absent(old, now);  // it accepts us and hangs up at once: wait, so as not to loop without a pause
  }
}

std::size_t Successor::farthest(Time now) const {
  if (patience_ && now < *patience_) return 0;
  std::size_t i = 0;
  while (i + 1 < candidates_.size() && passed_over(candidates_[i], now)) ++i;
  return i;
}

bool Successor::passed_over(const Candidate& candidate, Time now) const {
  switch (candidate.state) {
    case Candidate::State::absent:
      return true;
    case Candidate::State::trying:
      return candidate.missing || now - candidate.since >= timing_.silence;
    case Candidate::State::untried:
    case Candidate::State::busy:
      return false;
  }
  return false;
}

void Successor::set(std::size_t candidate, Candidate::State state, Time since, bool missing) {
  candidates_[candidate] = {state, since, missing};
}

}  // namespace limb_ring::link
