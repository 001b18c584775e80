#include "io/output.h"

#include <stdexcept>
#include <string>
#include <system_error>

#include "io/memory_line.h"
#include "io/udp_line.h"
#include "io/unix_line.h"
#include "wire/slice.h"

namespace limb_ring::link {
namespace {

/// Asking again does not help: somebody has to change something.
bool for_good(Refusal refusal) {
  return refusal == Refusal::wrong_ring || refusal == Refusal::not_in_ring || refusal == Refusal::wrong_version ||
         refusal == Refusal::other_ring_file || of_keys(refusal);
}

const OutputSettings& checked(const OutputSettings& settings) {
  if (settings.candidates.empty()) {
    throw std::invalid_argument("an output needs candidates: the successor first, ourselves last");
  }
  for (const Candidate& candidate : settings.candidates) {
    if (candidate.endpoint.transport == Endpoint::Transport::udp) udp_address(candidate.endpoint);
  }
  return settings;
}

}  // namespace

Output::Output(boost::asio::io_context& io, const OutputSettings& settings, OutputHandler& handler)
    : io_(io),
      settings_(checked(settings)),
      handler_(handler),
      successor_(settings.candidates.size(), settings.timing, Clock::now()),
      silence_(settings.timing),
      ticker_(io, settings.timing.idle, [this](Time now) { tick(now); }) {
  advance(Clock::now());
}

void Output::close() {
  if (closed_) return;
  closed_ = true;
  ticker_.stop();
  for (auto& [candidate, attempt] : attempts_) attempt.line->close();
  attempts_.clear();
  if (current_) current_->close();
  current_.reset();
}

void Output::write(wire::ByteView framed_slices) {
  if (!current_) {
    counters_.discarded += framed_slices.size;
    return;
  }
  counters_.bytes += framed_slices.size;
  wrote_ = true;
  current_->write(framed_slices);
}

void Output::write_late(wire::ByteView framed_slice) {
  if (current_ && current_->hold_back(framed_slice)) counters_.bytes += framed_slice.size;
}

void Output::set_wire(Wire wire) {
  if (closed_ || wire == wire_) return;
  wire_ = wire;
  if (wire == Wire::whole) return advance(Clock::now());
  give_up_attempts(Clock::now());
  if (wire == Wire::cut && current_) cut();
}

// They count as busy, which is alive: once the wire is whole, each is asked again before it is passed over.
void Output::give_up_attempts(Time now) {
  for (auto& [candidate, attempt] : attempts_) {
    attempt.line->sever();
    successor_.busy(candidate, now);
  }
  attempts_.clear();
}

void Output::cut() {
  current_->sever();
  lose(Successor::Loss::ended, "the wire is cut");
}

void Output::advance(Time now) {
  if (closed_ || wire_ != Wire::whole) return;
  while (const auto candidate = successor_.next(now)) {
    if (!attempt(*candidate, now)) successor_.absent(*candidate, now);
  }
}

bool Output::attempt(std::size_t candidate, Time now) try {
  ++counters_.attempts;
  auto line = make_line(candidate);
  if (!line->start()) return false;
  attempts_[candidate] = {std::move(line), now};
  return true;
} catch (const std::system_error&) {
  return false;  // the kernel watches no more descriptors for us: later, perhaps
}

std::shared_ptr<Downstream> Output::make_line(std::size_t candidate) {
  const Endpoint& endpoint = settings_.candidates[candidate].endpoint;
  const UdpDownstream::Peer peer{candidate, settings_.candidates[candidate].id};
  Downstream::Owner& owner = *this;
  if (endpoint.transport == Endpoint::Transport::udp) {
    return std::make_shared<UdpDownstream>(io_, udp_address(endpoint), settings_.self, peer, owner, counters_);
  }
  if (endpoint.transport == Endpoint::Transport::shm) {
    return std::make_shared<MemoryDownstream>(io_, endpoint.path, settings_.self, candidate,
                                              queue_capacity(settings_.candidates.size()), owner, counters_);
  }
  return std::make_shared<UnixDownstream>(io_, endpoint.path, settings_.self, candidate, owner, counters_);
}

bool Output::is_current(std::size_t candidate) const {
  return current_ && successor_.current() == candidate && attempts_.count(candidate) == 0;
}

void Output::on_accepted(std::size_t candidate) {
  if (is_current(candidate)) return;
  if (current_) hang_up("a nearer node is back");
  if (!closed_) use(candidate);
}

void Output::use(std::size_t candidate) {
  const Time now = Clock::now();
  successor_.accepted(candidate, now);
  current_ = attempts_.at(candidate).line;
  attempts_.erase(candidate);
  while (!attempts_.empty() && attempts_.rbegin()->first > candidate) {
    abandon(attempts_.rbegin()->first);
  }
  ++counters_.connects;
  refusals_.forget(settings_.candidates[candidate].id);
  report_once_.forget();
  silence_.restart(now);
  write_idle();  // over UDP, this takes up the session
  handler_.on_output_up(to());
}

void Output::on_refused(std::size_t candidate, const LinkHeader& refuse) {
  const Refusal refusal = refuse.refusal;
  count(refusal);
  const bool alive = refusal == Refusal::busy || refusal == Refusal::replaced;
  const std::string reason = reason_of(refuse);
  const Time now = Clock::now();
  if (is_current(candidate)) {
    lose(alive ? Successor::Loss::replaced : Successor::Loss::ended, reason);
  } else {
    abandon(candidate);
    if (!alive) {
      successor_.absent(candidate, now);
    } else if (!successor_.says_busy(candidate, now)) {
      tell(candidate, "passed over: for 10 s it has said that a nearer node precedes it, but none does");
    }
    if (for_good(refusal)) note(candidate, reason);
  }
  advance(now);
}

void Output::on_hint(std::size_t candidate, const LinkHeader& refuse) {
  if (!for_good(refuse.refusal)) return;
  count(refuse.refusal);
  note(candidate, reason_of(refuse));
}

void Output::note(std::size_t candidate, const std::string& reason) {
  refusals_.note(settings_.candidates[candidate].id, reason);
  tell(candidate, reason);
}

void Output::count(Refusal refusal) {
  ++counters_.refused;
  link::count(refusal, counters_);
}

void Output::on_no_node(std::size_t candidate) {
  tell(candidate, kNoNode);
  on_ended(candidate, kNoNode);
}

void Output::tell(std::size_t candidate, std::string_view reason) {
  const std::uint8_t id = settings_.candidates[candidate].id;
  if (report_once_(std::to_string(id) + " " + std::string(reason))) handler_.on_output_refused(id, reason);
}

void Output::on_ended(std::size_t candidate, std::string_view reason) {
  const Time now = Clock::now();
  if (is_current(candidate)) {
    lose(Successor::Loss::ended, reason);
  } else {
    abandon(candidate);
    successor_.absent(candidate, now);
  }
  advance(now);
}

void Output::on_heard(std::size_t candidate) {
  if (is_current(candidate)) silence_.heard();
}

void Output::on_drained(std::size_t candidate) {
  if (is_current(candidate)) handler_.on_output_ready();
}

void Output::abandon(std::size_t candidate) {
  const auto found = attempts_.find(candidate);
  if (found == attempts_.end()) return;
  const auto line = std::move(found->second.line);
  attempts_.erase(found);
  line->close();
}

void Output::lose(Successor::Loss loss, std::string_view reason) {
  successor_.lost(loss, Clock::now());
  hang_up(reason);
}

void Output::hang_up(std::string_view reason) {
  ++counters_.losses;
  current_->close();
  current_.reset();
  handler_.on_output_lost(reason);
}

void Output::tick(Time now) {
  if (current_) tick_current(now);
  if (!closed_) tick_attempts(now);
  if (!closed_) advance(now);
}

void Output::tick_current(Time now) {
  if (!wrote_) write_idle();
  wrote_ = false;
  const auto judged = current_;
  judged->tick();
  if (current_ != judged || !silence_.tick(now)) return;
  ++counters_.silences;
  lose(Successor::Loss::silent, "silent: dead or frozen");
}

void Output::write_idle() {
  if (!current_->drained() || wire_ != Wire::whole) return;
  ++counters_.idle_slices;
  current_->say_idle();
}

void Output::tick_attempts(Time now) {
  ++ticks_;
  const auto attempts = attempts_;
  const std::size_t turns = 2 + attempts.size() / 8;  // with many dead nodes each is asked less often
  for (const auto& [candidate, attempt] : attempts) {
    if (now - attempt.since >= settings_.timing.attempt) {
      abandon(candidate);
      successor_.absent(candidate, now);
    } else if ((ticks_ + candidate) % turns == 0) {
      attempt.line->ask_again();
    }
  }
}

Successor::Successor(std::size_t candidates, const Timing& timing, Time now)
    : timing_(timing), candidates_(candidates), patience_(now + timing.first_successor) {}

std::optional<std::size_t> Successor::next(Time now) {
  const std::size_t count = current_ ? *current_ : farthest(now) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    if (candidates_[i].state == Candidate::State::trying || candidates_[i].since > now) continue;
    Candidate& next = candidates_[i];
    next = {Candidate::State::trying, now, next.missing, next.busy_since};
    return i;
  }
  return {};
}

void Successor::absent(std::size_t candidate, Time now) {
  set(candidate, Candidate::State::absent, now + timing_.candidate_retry(candidates_.size()), true);
}

void Successor::busy(std::size_t candidate, Time now) {
  set(candidate, Candidate::State::busy, now + timing_.candidate_retry(candidates_.size()));
}

// One that is alive is nearer to those beyond it than we are: they may be right.
bool Successor::says_busy(std::size_t candidate, Time now) {
  const Time since = candidates_[candidate].busy_since.value_or(now);
  const bool ourselves = candidate + 1 == candidates_.size();
  const bool believed = ourselves || now - since < kBelieved;
  believed ? busy(candidate, now) : absent(candidate, now);
  candidates_[candidate].busy_since = since;
  for (std::size_t i = candidate + 1; believed && i < candidates_.size(); ++i) candidates_[i].busy_since.reset();
  return believed;
}

void Successor::accepted(std::size_t candidate, Time now) {
  for (std::size_t i = candidate; i < candidates_.size(); ++i) candidates_[i] = {};
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
  candidates_[candidate] = {state, since, missing, {}};
}

}  // namespace limb_ring::link
