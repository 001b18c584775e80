#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "judge/promise.h"

namespace limb_ring::promises {

/// A promise that was not kept.
struct Breach {
  Promise promise;
  std::uint8_t node = 0;    ///< at which
  std::uint8_t source = 0;  ///< of the packet
  std::int64_t at_ns = 0;   ///< by the nodes' clock
  std::string what;         ///< the packet, and what became of it
};

/// Why something could not be judged.
enum class Unjudged : std::uint8_t {
  receiver_unknown,    ///< nobody looks at the receiver, or not long enough
  receiver_restarted,  ///< the receiver or its CPU was restarted meanwhile
  source_unknown,      ///< nobody looks at the source, or not long enough
  observations_lost,   ///< they came too fast
  ring_changed,        ///< a broadcast, while nodes came or went
  alike,               ///< beside others of the same data, of which one may have been taken or not
  too_many             ///< too much is under way
};
constexpr std::size_t kUnjudged = 7;
const char* to_string(Unjudged why);

/// What was judged, and what was not.
struct JudgeCounts {
  std::uint64_t sends = 0;    ///< asked for
  std::uint64_t judged = 0;   ///< of those
  std::uint64_t packets = 0;  ///< given to CPUs; and pins pulled
  std::uint64_t lost = 0;     ///< observations
  std::uint64_t breaches = 0;
  std::array<std::uint64_t, kUnjudged> unjudged{};  ///< sends and packets, by why

  std::uint64_t all_unjudged() const;
};
/// "1200 sends, 1180 packets; not judged: 3 (the receiver was restarted)"
std::string describe(const JudgeCounts& counts);

/// Where the judge reports broken promises, and counts what it could not judge.
class JudgeReport {
 public:
  using OnBreach = std::function<void(const Breach&)>;
  /// @param told_again for this time, a breach of the same promise at the same node and source is not told again
  JudgeReport(OnBreach on_breach, std::chrono::nanoseconds told_again)
      : on_breach_(std::move(on_breach)), told_again_(told_again) {}

  void break_promise(Promise promise, std::uint8_t node, std::uint8_t source, std::int64_t at, std::string what);
  /// Counts something that cannot be judged. @return true, for callers that return whether they are done with it
  bool leave_unjudged(Unjudged why) {
    ++counts.unjudged[static_cast<std::size_t>(why)];
    return true;
  }

  JudgeCounts counts;

 private:
  OnBreach on_breach_;
  std::chrono::nanoseconds told_again_;
  std::map<std::tuple<Promise, std::uint8_t, std::uint8_t>, std::int64_t> told_;  ///< when, of node and source
};

}  // namespace limb_ring::promises
