#include "ring/ring_clock.h"

#include <chrono>

#include "io/process_state.h"
#include "limb_ring/ring_directory.h"
#include "ring/connect_node.h"
#include "ring/lock_files.h"

namespace limb_ring::live {

using nlohmann::json;

namespace {

constexpr std::chrono::milliseconds kClockAnswer{2000};

bool answers_as_virtual(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  const auto nodes = held_nodes(folder);
  return !nodes.empty() && holder_of(folder, nodes.front().node).on_virtual_ring &&
         !process::is_stopped(nodes.front().pid);
}

}  // namespace

json ring_clock(const std::string& ring) {
  if (!answers_as_virtual(ring)) return json();
  try {
    HostPort port = connect_ring(ring);
    json clock = json::parse(port.ask(R"({"do": "clock"})", kClockAnswer));
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
  return "the virtual clock of ring " + ring + " stands; 'ringctl clock run' lets it go on";
}

std::string with_standing_clock(const std::string& problem, const std::string& ring) {
  const std::string standing = standing_clock(ring);
  return standing.empty() ? problem : problem + ": " + standing;
}

}  // namespace limb_ring::live
