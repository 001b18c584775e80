#include "tools/ringctl/ring_clock.h"

#include <cstdio>

#include "tools/common/text_table.h"
#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

/// Below this the ring is on time: it goes on in steps.
constexpr double kOnTime = 0.005;

std::string seconds(double value) { return app::number(value, 3) + " s"; }

}  // namespace

void require_clock_goes(const std::string& ring) {
  const std::string standing = standing_clock(ring);
  if (!standing.empty()) throw NotKnown(standing + ", and what was asked for may happen then");
}

std::string pace_text(const json& pace) {
  if (!pace.is_number()) return "max";
  char text[32];
  std::snprintf(text, sizeof text, "%g", pace.get<double>());
  return text;
}

std::string clock_words(const json& clock) {
  if (!clock.is_object()) return "";
  const double late = clock.at("late_s").get<double>(), lost = clock.at("lost_s").get<double>();
  const char* stands = clock.value("paused", false) ? " stands" : "";
  return std::string("; virtual clock") + stands + " at " + seconds(clock.at("now_s").get<double>()) + ", pace " +
         pace_text(clock.at("pace")) + (clock.contains("allowed_ns") ? ", following another" : "") +
         (late >= kOnTime ? ", " + seconds(late) + " late" : "") + (lost > 0 ? ", " + seconds(lost) + " lost" : "");
}

}  // namespace limb_ring::ringctl
