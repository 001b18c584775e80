#include "app/ringctl/ring_clock.h"

#include <cstdio>

#include "app/common/text_table.h"
#include "app/ringctl/answers.h"
#include "app/ringctl/connect_node.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/ring_access.h"
#include "limb_ring/ring_directory.h"
#include "live/lock_files.h"
#include "process/process_state.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

/// The host port of a virtual ring itself, of no node: 255.host (daemon/host/requests.md).
const std::string kRingPort = std::to_string(kBroadcast);

/// Below this the ring is on time: it goes on in steps.
constexpr double kOnTime = 0.005;

bool answers_as_virtual(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  const auto nodes = live::held_nodes(folder);
  return !nodes.empty() && live::holder_of(folder, nodes.front().node).on_virtual_ring &&
         !process::is_stopped(nodes.front().pid);
}

std::string seconds(double value) { return app::number(value, 3) + " s"; }

}  // namespace

json ring_clock(const std::string& ring) {
  if (!answers_as_virtual(ring)) return json();
  try {
    HostPort port = connect_node(ring, kRingPort);
    json clock = json::parse(port.ask(R"({"do": "clock"})", kAnswerTime));  // ask() itself tells of the clock
    clock["now_s"] = clock.at("now_ns").get<double>() / 1e9;
    clock.erase("now_ns");
    return clock;
  } catch (const std::exception&) {
    return json();  // it ends just now
  }
}

std::string standing_clock(const std::string& ring) {
  const json clock = ring_clock(ring);
  if (!clock.is_object() || !clock.value("paused", false)) return "";
  return "the virtual clock of ring " + ring + " stands; 'ringctl run' lets it go on";
}

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
