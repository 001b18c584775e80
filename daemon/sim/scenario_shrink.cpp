#include "sim/scenario_shrink.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <vector>

#include "config/entry.h"
#include "config/quantity.h"
#include "sim/load_scenario.h"

namespace limb_ring::scenario {

namespace {

namespace fs = std::filesystem;

/// A place in the file: the numbers of entries, from the root down, of maps and sequences alike.
using Place = std::vector<std::size_t>;

YAML::Node child(const YAML::Node& node, std::size_t number) {
  if (node.IsSequence()) return node[number];
  auto entry = node.begin();
  std::advance(entry, static_cast<std::ptrdiff_t>(number));
  return entry->second;
}

std::string key_of(const YAML::Node& map, std::size_t number) {
  auto entry = map.begin();
  std::advance(entry, static_cast<std::ptrdiff_t>(number));
  return entry->first.Scalar();
}

YAML::Node at(const YAML::Node& root, const Place& place) {
  YAML::Node node = root;
  for (const std::size_t number : place) node.reset(child(node, number));
  return node;
}

/// Removes `count` entries. @pre it is a map or a sequence
void take_out(YAML::Node node, std::size_t from, std::size_t count) {
  YAML::Node rest(node.Type());
  rest.SetStyle(node.Style());
  std::size_t number = 0;
  for (const auto& entry : node) {
    const bool out = number >= from && number < from + count;
    ++number;
    if (out) continue;
    if (node.IsMap())
      rest.force_insert(entry.first, entry.second);
    else
      rest.push_back(entry);
  }
  node = rest;
}

/// Keys that are never left out: they identify the scenario and its world, and a send without `count` would not end.
bool has_to_stay(const std::string& key) {
  return key == "scenario" || key == "seed" || key == "count" || key == "world";
}

std::string without_numbers(const std::string& text) {
  std::string words;
  for (const char c : text) {
    if (!config::is_digit(c))
      words += c;
    else if (words.empty() || words.back() != '#')
      words += '#';
  }
  return words;
}

/// Whether the missed condition would hold later. If it does, it is missed only for its time, and must stay so: after
/// its cause was left out it would never hold.
bool holds_later(Scenario scenario, std::uint64_t seed, const Unmet& missed) {
  const auto is_missed = [&missed](const Step& step) {
    return step.when && missed.expected == expectation(*step.when, step.within.sim);
  };
  const auto step = std::find_if(scenario.steps.begin(), scenario.steps.end(), is_missed);
  if (step == scenario.steps.end()) return false;
  step->within.sim = 10 * step->within.sim + std::chrono::seconds(1);
  scenario.steps.erase(std::next(step), scenario.steps.end());
  return !run_scenario(scenario, seed).unmet;
}

class Shrinker {
 public:
  explicit Shrinker(const ShrinkRequest& request) : request_(request) {}

  std::optional<Shrunk> run() {
    const std::string given = request_.text ? *request_.text : config::read_file(request_.path);
    best_ = config::parse_yaml(given, request_.path);
    const Scenario scenario = parse_scenario(given, request_.path);
    result_.before = result_.after = size_of(scenario);
    result_.run = run_scenario(scenario, request_.seed.value_or(scenario.seed));
    if (!result_.run.unmet) return {};
    wanted_ = *result_.run.unmet;
    fails_before_end_ = fails_without_end(scenario);
    comes_late_ = holds_later(scenario, result_.run.seed, wanted_);
    best_["seed"] = result_.run.seed;
    while (leave_out({}) || lessen({})) {
    }
    result_.text = text();
    return result_;
  }

 private:
  /// Whether it fails before the end. If so, the end of the soak's world, which takes most of a run's time, is skipped.
  bool fails_without_end(Scenario scenario) {
    if (scenario.world != World::soak) return false;
    scenario.ends_mended = false;
    const ScenarioRun run = run_scenario(scenario, result_.run.seed);
    return run.unmet && alike(*run.unmet, wanted_);
  }

  /// It misses the same expectation in the same way.
  bool fails_alike(const YAML::Node& candidate) {
    result_.stopped = result_.runs >= request_.most_runs;
    if (result_.stopped) return false;
    try {
      Scenario scenario = parse_scenario(YAML::Dump(candidate), request_.path);
      if (!lasts(scenario) || !expects_something(scenario)) return false;  // 'scenario run' would not take it
      if (fails_before_end_) scenario.ends_mended = false;
      ScenarioRun run = run_scenario(scenario, scenario.seed);
      request_.tell(++result_.runs);
      if (!run.unmet || !alike(*run.unmet, wanted_) || (comes_late_ && !holds_later(scenario, scenario.seed, wanted_)))
        return false;
      result_.run = std::move(run);
      result_.after = size_of(scenario);
      return true;
    } catch (const config::ConfigError&) {
      return false;  // that entry is needed
    }
  }

  template <class Edit>
  bool try_edit(const Place& place, Edit edit) {
    YAML::Node candidate = YAML::Clone(best_);
    edit(at(candidate, place));
    if (!fails_alike(candidate)) return false;
    best_.reset(candidate);
    return true;
  }

  /// Tries to remove many entries at once first: most of a long scenario has nothing to do with the failure.
  bool leave_out_of_sequence(const Place& place) {
    bool any = false;
    for (std::size_t count = at(best_, place).size(); count > 0; count /= 2) {
      for (std::size_t from = 0; from < at(best_, place).size();) {
        const bool out = try_edit(place, [=](YAML::Node node) { take_out(node, from, count); });
        any = any || out;
        if (!out) from += count;
      }
    }
    return any;
  }

  bool leave_out_of_map(const Place& place) {
    bool any = false;
    for (std::size_t number = at(best_, place).size(); number-- > 0;) {
      if (has_to_stay(key_of(at(best_, place), number))) continue;
      any = try_edit(place, [=](YAML::Node node) { take_out(node, number, 1); }) || any;
    }
    return any;
  }

  bool leave_out(const Place& place) {
    const YAML::Node node = at(best_, place);
    bool any = node.IsSequence() && leave_out_of_sequence(place);
    any = (node.IsMap() && leave_out_of_map(place)) || any;
    return each_below(place, [this](const Place& below) { return leave_out(below); }) || any;
  }

  /// Makes whole numbers smaller: tries 1 first, then half.
  bool lessen(const Place& place) {
    const YAML::Node node = at(best_, place);
    if (place.size() == 1 && key_of(best_, place[0]) == "seed") return false;
    if (!node.IsScalar()) return each_below(place, [this](const Place& below) { return lessen(below); });
    std::uint64_t number = 0;
    if (!YAML::convert<std::uint64_t>::decode(node, number) || number < 2) return false;
    for (const std::uint64_t less : {std::uint64_t{1}, number / 2})
      if (try_edit(place, [less](YAML::Node scalar) { scalar = less; })) return true;
    return false;
  }

  template <class Visit>
  bool each_below(const Place& place, Visit visit) {
    bool any = false;
    const bool has_entries = at(best_, place).IsMap() || at(best_, place).IsSequence();
    for (std::size_t number = 0; has_entries && number < at(best_, place).size(); ++number) {
      Place below = place;
      below.push_back(number);
      any = visit(below) || any;
    }
    return any;
  }

  std::string text() {
    if (best_["ring"]) {
      const fs::path ring = fs::path(request_.path).parent_path() / best_["ring"].Scalar();
      best_["ring"] = fs::absolute(ring).lexically_normal().lexically_proximate(fs::absolute(request_.beside)).string();
    }
    const std::string how = result_.stopped ? "made smaller until stopped" : "made as small as it could be";
    return "# " + request_.path + ", " + how + ".\n# Expected: " + wanted_.expected +
           "\n# Seen:     " + result_.run.unmet->seen + "\n" + YAML::Dump(best_) + "\n";
  }

  const ShrinkRequest& request_;
  YAML::Node best_;
  Unmet wanted_;
  bool comes_late_ = false;        ///< it is missed for its time alone
  bool fails_before_end_ = false;  ///< in the soak's world
  Shrunk result_;
};

}  // namespace

ScenarioSize size_of(const Scenario& scenario) {
  ScenarioSize size;
  for (const Step& step : scenario.steps) {
    if (std::holds_alternative<Fault>(step.action) || std::holds_alternative<SoakAction>(step.action)) ++size.faults;
    if (const auto* send = std::get_if<Send>(&step.action))
      size.sends += send->from.size() * std::max<std::uint64_t>(send->count, 1);
  }
  return size;
}

std::string in_words(const ScenarioSize& size) {
  return std::to_string(size.faults) + (size.faults == 1 ? " fault and " : " faults and ") +
         std::to_string(size.sends) + (size.sends == 1 ? " send" : " sends");
}

bool alike(const Unmet& one, const Unmet& other) {
  return one.expected == other.expected && without_numbers(one.seen) == without_numbers(other.seen);
}

// Removes large pieces first, as most have nothing to do with the failure; and from the end on, since later steps
// depend on earlier ones.
std::vector<std::size_t> needed_steps(std::size_t count, std::size_t most_runs,
                                      const std::function<bool(const std::vector<std::size_t>&)>& fails_alike) {
  std::vector<std::size_t> needed(count);
  std::iota(needed.begin(), needed.end(), std::size_t{0});
  bool any = false;
  std::size_t runs = 0;
  for (std::size_t piece = count; piece > 0; piece = any && piece == 1 ? 1 : piece / 2) {
    any = false;
    for (std::size_t end = needed.size(); end > 0 && runs < most_runs; ++runs) {
      const std::size_t from = end > piece ? end - piece : 0;
      std::vector<std::size_t> fewer = needed;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(from), fewer.begin() + static_cast<std::ptrdiff_t>(end));
      end = from;
      if (!fails_alike(fewer)) continue;
      needed = std::move(fewer);
      any = true;
    }
  }
  return needed;
}

std::optional<Shrunk> shrink(const ShrinkRequest& request) { return Shrinker(request).run(); }

}  // namespace limb_ring::scenario
