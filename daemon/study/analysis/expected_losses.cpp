#include "study/analysis/expected_losses.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "config/core_settings.h"
#include "config/quantity.h"

namespace limb_ring::study {

namespace {

using config::NodeConfig;
using config::RingConfig;

constexpr double kDay = 24 * 3600.0, kHour = 3600.0;

std::string number_text(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3g%s", value, unit);
  return text;
}

std::string percent_text(double share) { return number_text(100 * share, " %"); }

/// For a share just below 1, how much is missing says more than the share.
std::string all_but(double share) {
  if (share == 1) return "always";
  const double missing = 1 - share;
  return "all but " + (missing < 1e-3 ? number_text(1e6 * missing, " in a million") : percent_text(missing));
}

std::string often(double seconds) {
  if (seconds < 120) return number_text(seconds, " s");
  if (seconds < 2 * kHour) return number_text(seconds / 60, " min");
  return seconds < 2 * kDay ? number_text(seconds / kHour, " h") : number_text(seconds / kDay, " days");
}

std::chrono::nanoseconds whole_way(const NodeConfig& node) { return node.link.whole_delay(); }

void add_silence(const RingConfig& ring, const NodeConfig& node, std::vector<std::string>& sentences) {
  const double seconds = seconds_to_false_silence(ring.timeouts, node.link.expected.loss);
  if (seconds >= kDay) return;
  const auto advised = advised_silence(ring.timeouts, node.link.expected.loss);
  sentences.push_back("the line into " + node.name + " loses " + percent_text(node.link.expected.loss) +
                      " and would be taken for broken every " + often(seconds) + ": timeouts.silence " +
                      config::format_time(ring.timeouts.silence) + " is too short, " + config::format_time(advised) +
                      " holds for a day");
}

/// A bypass has to be made, over a line that takes its time, before a lost input is called a broken line.
void add_break_grace(const RingConfig& ring, std::vector<std::string>& sentences) {
  std::chrono::nanoseconds longest{0};
  for (const NodeConfig& node : ring.nodes) longest = std::max(longest, whole_way(node));
  const auto least = 2 * longest + 3 * ring.timeouts.idle;
  if (longest.count() == 0 || ring.timeouts.break_grace >= least) return;
  sentences.push_back("a bypass takes up to " + config::format_time(least) + " on these lines: timeouts.break_grace " +
                      config::format_time(ring.timeouts.break_grace) + " is too short");
}

}  // namespace

std::optional<ExpectedLosses> expected_losses(const RingConfig& ring) {
  ExpectedLosses losses;
  for (const NodeConfig& node : ring.nodes) losses.home *= 1 - node.link.expected.loss;
  if (losses.home == 1) return std::nullopt;
  losses.delivered = 1 - std::pow(1 - losses.home, wire::kTries);
  losses.tries = losses.delivered / losses.home;
  losses.timeout = setup::core_settings(ring, ring.nodes[0], 1).send_timeout();
  return losses;
}

double seconds_to_false_silence(const config::Timeouts& timeouts, double loss) {
  if (loss <= 0) return std::numeric_limits<double>::infinity();
  const double signs =
      std::floor(static_cast<double>(timeouts.silence.count()) / static_cast<double>(timeouts.idle.count()));
  const double tick = std::chrono::duration<double>(timeouts.idle).count();
  return tick / ((1 - loss) * std::pow(loss, signs));
}

config::milliseconds advised_silence(const config::Timeouts& timeouts, double loss) {
  config::Timeouts longer = timeouts;
  longer.silence = 2 * timeouts.idle;
  while (seconds_to_false_silence(longer, loss) < kDay) longer.silence += timeouts.idle;
  return longer.silence;
}

std::vector<std::string> short_timeouts(const RingConfig& ring) {
  std::vector<std::string> sentences;
  for (const NodeConfig& node : ring.nodes) add_silence(ring, node, sentences);
  add_break_grace(ring, sentences);
  return sentences;
}

std::string expected_words(const RingConfig& ring) {
  std::string lines;
  for (const NodeConfig& node : ring.nodes) {
    const config::ExpectedConfig& expected = node.link.expected;
    if (expected.delay.count() == 0 && expected.loss == 0) continue;
    lines += (lines.empty() ? "" : "; ") + std::string("into ") + node.name + " " +
             config::format_time(expected.delay) + " one way, " + percent_text(expected.loss) + " lost";
  }
  if (lines.empty()) return {};
  std::string text = "Expected of the network: " + lines + ". Bounds hold for packets that are not lost.\n";
  if (const auto losses = expected_losses(ring))
    text += "A packet comes home at its first try with " + percent_text(losses->home) + ", within four tries " +
            all_but(losses->delivered) + "; " + number_text(losses->tries, "") +
            " tries on average, each further one " +
            config::format_time(std::chrono::ceil<std::chrono::microseconds>(losses->timeout)) + " later.\n";
  return text;
}

}  // namespace limb_ring::study
