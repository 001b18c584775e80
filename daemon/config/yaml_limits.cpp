#include "config/yaml_limits.h"

#include <algorithm>

#include "config/config_error.h"
#include "config/yaml_file.h"

namespace limb_ring::config {

void YamlLimits::OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) {
  const auto target = anchored_.find(anchor);
  if (target == anchored_.end()) refuse(mark, "a list or map holds itself; allowed: aliases of what has ended before");
  add(mark, YAML::NullAnchor, target->second);
}

void YamlLimits::add(const YAML::Mark& mark, YAML::anchor_t anchor, const Extent& extent) {
  if (anchor != YAML::NullAnchor) anchored_[anchor] = extent;
  if (open_.empty()) return;
  Extent& outer = open_.back().extent;
  outer.values += extent.values;
  outer.depth = std::max(outer.depth, extent.depth + 1);
  check_depth(mark, open_.size() + extent.depth);
  if (outer.values > kMostValues)
    refuse(mark,
           "too many values, each alias counted as all that it stands for; allowed: " + std::to_string(kMostValues));
}

void YamlLimits::begin(const YAML::Mark& mark, YAML::anchor_t anchor) {
  open_.push_back({mark, anchor, {1, 1}});
  check_depth(mark, open_.size());
}

void YamlLimits::end() {
  const Open closed = open_.back();
  open_.pop_back();
  add(closed.mark, closed.anchor, closed.extent);
}

void YamlLimits::check_depth(const YAML::Mark& mark, std::size_t depth) const {
  if (depth > kMostDepth)
    refuse(mark, "lists and maps are nested too deep; allowed: " + std::to_string(kMostDepth) + " levels");
}

void YamlLimits::refuse(const YAML::Mark& mark, const std::string& problem) const {
  throw ConfigError(place_in(name_, mark) + ": " + problem);
}

}  // namespace limb_ring::config
