#include "study/analysis/response.h"

#include <algorithm>

namespace limb_ring::study {

namespace {

/// Messages asked for from 0 until `end`, those at the very end too.
std::int64_t arrivals(const Contender& other, Duration end) { return (end + other.jitter) / other.period + 1; }

/// One stream among those of its unit.
class Analysis {
 public:
  Analysis(const std::vector<Contender>& contenders, std::size_t which, Duration ahead, Duration limit)
      : all_(contenders), which_(which), own_(contenders[which]), limit_(limit) {
    for (const Contender& other : all_)
      if (other.rank > own_.rank) lower_ = std::max(lower_, other.longest);
    blocked_ = std::max(ahead, lower_);
  }

  std::optional<Response> worst() const {
    const auto busy = busy_period();
    if (!busy) return std::nullopt;
    Response worst;
    Duration wait = blocked_;
    for (std::int64_t q = 0; q < arrivals(own_, *busy); ++q) {
      wait = start(q, wait);
      if (wait > limit_) return std::nullopt;
      const Duration after = wait - std::max(Duration{0}, q * own_.period - own_.jitter);
      if (q == 0 || after > worst.wait) worst = described(q, wait, after);
    }
    return worst;
  }

 private:
  bool goes_first(std::size_t k) const { return k != which_ && all_[k].rank <= own_.rank; }

  /// The load that competes: 1 or more has no bound.
  double load() const {
    double load = own_.load();
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (goes_first(k)) load += all_[k].load();
    return load;
  }

  std::optional<Duration> busy_period() const {
    if (load() >= 1) return std::nullopt;
    Duration busy = blocked_ + own_.work;
    for (Duration before{-1}; busy != before;) {
      before = busy;
      busy = blocked_ + arrivals(own_, before) * own_.work;
      for (std::size_t k = 0; k < all_.size(); ++k)
        if (goes_first(k)) busy += arrivals(all_[k], before) * all_[k].work;
      if (busy > limit_) return std::nullopt;
    }
    return busy;
  }

  /// When the last packet of message q starts, from below. Stops above the limit.
  Duration start(std::int64_t q, Duration from) const {
    Duration wait = from;
    for (Duration before{-1}; wait != before && wait <= limit_;) {
      before = wait;
      wait = blocked_ + (q + 1) * own_.work - own_.last;
      for (std::size_t k = 0; k < all_.size(); ++k)
        if (goes_first(k)) wait += arrivals(all_[k], before) * all_[k].work;
    }
    return wait;
  }

  Response described(std::int64_t q, Duration wait, Duration after) const {
    Response response;
    response.wait = after;
    response.own = static_cast<std::size_t>(q + 1) * own_.jobs;
    response.lower = lower_.count() != 0;
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (goes_first(k)) response.others += static_cast<std::size_t>(arrivals(all_[k], wait)) * all_[k].jobs;
    return response;
  }

  const std::vector<Contender>& all_;
  const std::size_t which_;
  const Contender& own_;
  const Duration limit_;
  Duration lower_{0};
  Duration blocked_{0};
};

}  // namespace

std::optional<Response> worst_response(const std::vector<Contender>& contenders, std::size_t which, Duration ahead,
                                       Duration limit) {
  return Analysis(contenders, which, ahead, limit).worst();
}

}  // namespace limb_ring::study
