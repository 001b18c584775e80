#include "tools/ringctl/fault_table.h"

#include "tools/common/text_table.h"

namespace limb_ring::ringctl {

using live::LiveFault;
using nlohmann::json;

namespace {

std::string left_of(const LiveFault& fault) {
  std::string left;
  if (fault.packets_left) left = std::to_string(*fault.packets_left) + " packets";
  if (fault.seconds_left) left += (left.empty() ? "" : ", ") + app::number(*fault.seconds_left) + " s";
  return left.empty() ? "until removed" : left;
}

}  // namespace

std::string fault_table(const std::vector<LiveFault>& faults) {
  std::vector<std::vector<std::string>> table{{"id", "fault", "since s", "struck", "left"}};
  for (const LiveFault& fault : faults)
    table.push_back({fault.id, fault.words, app::number(fault.age_s),
                     fault.waits       ? "waits"
                     : fault.hits == 0 ? "-"
                                       : std::to_string(fault.hits),
                     left_of(fault)});
  return app::text_table(table);
}

json to_json(const LiveFault& fault) {
  return {{"id", fault.id},
          {"name", fault.name},
          {"fault", fault.words},
          {"age_s", fault.age_s},
          {"waits", fault.waits},
          {"hits", fault.hits},
          {"packets_left", fault.packets_left ? json(*fault.packets_left) : json()},
          {"seconds_left", fault.seconds_left ? json(*fault.seconds_left) : json()}};
}

}  // namespace limb_ring::ringctl
