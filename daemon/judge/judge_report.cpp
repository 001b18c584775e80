#include "judge/judge_report.h"

#include <numeric>

namespace limb_ring::promises {

const char* to_string(Unjudged why) {
  switch (why) {
    case Unjudged::receiver_unknown:
      return "the receiver was not seen for long enough";
    case Unjudged::receiver_restarted:
      return "the receiver or its CPU was restarted";
    case Unjudged::source_unknown:
      return "the source was not seen for long enough";
    case Unjudged::observations_lost:
      return "observations were lost";
    case Unjudged::ring_changed:
      return "broadcasts while the ring changed";
    case Unjudged::alike:
      return "equal data of a send that may have been taken or not";
    case Unjudged::too_many:
      return "too many under way";
  }
  return "";
}

std::uint64_t JudgeCounts::all_unjudged() const {
  return std::accumulate(unjudged.begin(), unjudged.end(), std::uint64_t{0});
}

std::string describe(const JudgeCounts& counts) {
  std::string text = std::to_string(counts.sends) + " sends, " + std::to_string(counts.packets) + " packets and pins";
  const char* before = "; not judged: ";
  for (std::size_t i = 0; i < kUnjudged; ++i) {
    if (counts.unjudged[i] == 0) continue;
    text += before + std::to_string(counts.unjudged[i]) + " (" + to_string(static_cast<Unjudged>(i)) + ")";
    before = ", ";
  }
  if (counts.lost != 0) text += "; " + std::to_string(counts.lost) + " observations lost";
  return text;
}

void JudgeReport::break_promise(Promise promise, std::uint8_t node, std::uint8_t source, std::int64_t at,
                                std::string what) {
  ++counts.breaches;
  const auto [told, first] = told_.try_emplace({promise, node, source}, at);
  if (!first && at - told->second < told_again_.count()) return;
  told->second = at;
  on_breach_({promise, node, source, at, std::move(what)});
}

}  // namespace limb_ring::promises
