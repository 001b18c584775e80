#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {
namespace {

std::string figure(const nlohmann::json& clock, const char* name) {
  return clock.is_object() ? app::number(clock[name].get<double>(), 3) : "-";
}

/// {"host": this one, "hosts": all names} of a ring that has hosts; else, and where no daemon answers, empty.
nlohmann::json hosts_of(const std::string& ring) {
  try {
    const RingAccess access = RingAccess::open(ring);
    if (access.hosts().empty()) return nlohmann::json::object();
    nlohmann::json names = nlohmann::json::array();
    for (const RingHost& host : access.hosts()) names.push_back(host.name);
    return {{"host", access.here()}, {"hosts", names}};
  } catch (const std::exception&) {
    return nlohmann::json::object();
  }
}

/// "waist (of waist, head)"
std::string words_of(const nlohmann::json& hosts) {
  if (hosts.empty()) return "-";
  std::string all;
  for (const auto& name : hosts["hosts"]) all += (all.empty() ? "" : ", ") + name.get<std::string>();
  return hosts["host"].get<std::string>() + " (of " + all + ")";
}

}  // namespace

int show_rings(bool as_json) {
  tell_unreadable_rings();
  for (const std::string& folder : live::ring_folders()) tell_unreadable(folder);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  std::vector<std::vector<std::string>> rows{{"ring", "nodes", "host", "clock", "at s", "pace", "late s", "lost s"}};
  for (const std::string& ring : live::held_rings()) {
    const std::string folder = ring_directory(ring);
    const std::vector<live::HeldNode> nodes = live::held_nodes(folder);
    if (nodes.empty()) continue;  // it ended meanwhile
    const auto count = std::count_if(nodes.begin(), nodes.end(),
                                     [&](const auto& node) { return live::holder_of(folder, node.node).held; });
    const char* kind = live::holder_of(folder, nodes.front().node).on_virtual_ring ? "virtual" : "live";
    const nlohmann::json clock = ring_clock(ring);
    const nlohmann::json hosts = hosts_of(ring);
    rows.push_back({ring, std::to_string(count), words_of(hosts), kind, figure(clock, "now_s"),
                    clock.is_object() ? pace_text(clock["pace"]) : "-", figure(clock, "late_s"),
                    figure(clock, "lost_s")});
    all.push_back({{"ring", ring}, {"nodes", count}, {"clock", kind}});
    if (!hosts.empty()) all.back().update(hosts);
    for (const auto& entry : clock.items()) all.back()[entry.key()] = entry.value();
  }
  if (as_json)
    std::cout << all.dump(2) << std::endl;
  else
    std::cout << (all.empty() ? "no ring is running\n" : app::text_table(rows)) << std::flush;
  return kDone;
}

}  // namespace limb_ring::ringctl
