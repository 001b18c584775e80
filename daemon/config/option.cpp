#include "config/option.h"

#include <algorithm>

namespace limb_ring::config {

void check_names(const Entry& map, const std::vector<std::string>& allowed, const std::vector<std::string>& required) {
  const std::string rule = "a map of " + join(allowed);
  Problems problems;
  for (const Member& member : map.members(rule)) {
    if (std::find(allowed.begin(), allowed.end(), member.name) != allowed.end()) continue;
    const std::string meant = closest(member.name, allowed);
    member.key.note(problems, meant.empty() ? "is unknown" : "is unknown, did you mean '" + meant + "'?",
                    join(allowed));
  }
  for (const std::string& name : required)
    if (!map.find(name)) map.note(problems, "'" + name + "' is missing", rule);
  problems.refuse_all();
}

}  // namespace limb_ring::config
