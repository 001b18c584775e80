#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <random>

#include "core/time.h"
#include "io/signal_wait.h"
#include "sim/goals.h"
#include "sim/trace.h"
#include "study/shrunk_soak.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::ring_sim {

namespace {

struct SoakOptions {
  std::uint64_t seeds = 1000;
  std::uint64_t first = 0;  ///< drawn where it is not given: ranges that were run before find less
  study::FoldingRings folding = study::FoldingRings::some;
  study::WorldKind world = study::WorldKind::usual;
  std::uint64_t failures = 1;
  std::optional<std::string> shrink_into;  ///< folder
  bool hashes = false;
  bool list_goals = false, require_goals = false;
  bool seek_unmet = false;
  study::RandomFaults::More more;   ///< of each seed, beside what it seeks
  std::vector<std::size_t> sought;  ///< places in sim::goals(); seeds take them in turn
  app::Format format = app::Format::text;
};

/// In how many seeds a goal was met, and how often.
struct GoalTally {
  std::uint64_t seeds = 0, times = 0;
};

/// Sends by outcome, hops, and goals, over all seeds so far.
struct Tally {
  std::uint64_t seeds = 0, hops = 0;
  std::array<std::uint64_t, wire::kOutcomes> ended{};
  std::vector<GoalTally> goals = std::vector<GoalTally>(sim::goals().size());

  void add(const study::RandomFaults& run) {
    ++seeds;
    hops += run.hops();
    for (std::size_t i = 0; i < ended.size(); ++i) ended[i] += run.ended()[i];
    const std::vector<std::uint64_t> met = run.goals_met();
    for (std::size_t i = 0; i < met.size(); ++i) {
      goals[i].seeds += met[i] != 0 ? 1 : 0;
      goals[i].times += met[i];
    }
  }
  app::Row row(const SoakOptions& options) const {
    app::Row out{{"first_seed", options.first}, {"seeds", seeds}, {"packet_hops", hops}};
    for (std::size_t i = 0; i < ended.size(); ++i) out[to_string(static_cast<core::Outcome>(i))] = ended[i];
    if (options.format != app::Format::json) return out;
    for (std::size_t i = 0; i < goals.size(); ++i)
      out["goals"][sim::goals()[i].name] = {{"seeds", goals[i].seeds}, {"times", goals[i].times}};
    return out;
  }
};

// ---- goals ----------------------------------------------------------------------------------

bool can_meet(study::WorldKind world, const sim::Goal& goal) {
  return static_cast<int>(world) >= static_cast<int>(goal.world);
}

std::string names_of(const std::vector<std::size_t>& goals) {
  std::string names;
  for (const std::size_t goal : goals) names += (names.empty() ? "" : ", ") + std::string(sim::goals()[goal].name);
  return names;
}

/// Which goal each seed seeks.
class Seeking {
 public:
  explicit Seeking(const SoakOptions& options) : options_(options), sought_(options.sought) {}

  /// Null: none.
  const sim::Goal* goal_of(std::uint64_t seed) const {
    if (sought_.empty() || (options_.seek_unmet && seed % 2 == 0)) return nullptr;
    return &sim::goals()[sought_[(options_.seek_unmet ? seed / 2 : seed) % sought_.size()]];
  }
  /// With --seek unmet: every kSeedsToLearn seeds, what none of them has met is sought by every second one.
  void learn(const Tally& tally, std::uint64_t next_seed) {
    if (!options_.seek_unmet || tally.seeds % kSeedsToLearn != 0) return;
    std::vector<std::size_t> unmet;
    for (std::size_t i = 0; i < tally.goals.size(); ++i)
      if (tally.goals[i].seeds == 0) unmet.push_back(i);
    if (unmet == sought_) return;
    sought_ = std::move(unmet);
    std::cerr << "From seed " << next_seed << " on every second seed seeks one of: " << names_of(sought_) << ".\n";
  }

 private:
  static constexpr std::uint64_t kSeedsToLearn = 100;

  const SoakOptions& options_;
  std::vector<std::size_t> sought_;
};

/// What was met in no seed, though the worlds that were run can meet it.
std::vector<std::size_t> never_met(const Tally& tally, const SoakOptions& options) {
  std::vector<std::size_t> never;
  for (std::size_t i = 0; i < tally.goals.size(); ++i)
    if (tally.goals[i].seeds == 0 && (options.seek_unmet || can_meet(options.world, sim::goals()[i])))
      never.push_back(i);
  return never;
}

std::string all_goals_text(const Tally& tally) {
  std::vector<app::Row> rows;
  for (std::size_t i = 0; i < tally.goals.size(); ++i)
    rows.push_back({{"goal", sim::goals()[i].name},
                    {"seeds", tally.goals[i].seeds},
                    {"times", tally.goals[i].times},
                    {"what", sim::goals()[i].sentence}});
  return app::format_rows(rows, app::Format::text);
}

std::string goals_text(const Tally& tally, const SoakOptions& options) {
  const std::vector<std::size_t> never = never_met(tally, options);
  const auto met = std::count_if(tally.goals.begin(), tally.goals.end(), [](auto& goal) { return goal.seeds != 0; });
  const std::string text = "Goals met: " + std::to_string(met) + " of " +
                           std::to_string(static_cast<std::size_t>(met) + never.size()) + " that these worlds can meet";
  return (options.list_goals ? all_goals_text(tally) : "") + text +
         (never.empty() ? ".\n" : "; never: " + names_of(never) + ".\n");
}

std::string violation_text(const study::RandomFaults& run) {
  const sim::Violation& broken = *run.violation();
  const std::string seed = std::to_string(run.origin().seed);
  return "seed " + seed + ": " + run.describe() + "\npromise broken: " + to_string(broken.promise) + "\nat " +
         std::to_string(core::picoseconds(broken.at.time_since_epoch())) + " ps: " + broken.what() +
         "\nagain with: ring_sim soak --first " + seed + " --seeds 1" + options_of(run.origin()) + "\n";
}

/// Writes the smallest scenario that fails as the run did into that folder, and says so.
/// @return false if it is still large
bool write_shrunk(const study::RandomFaults& run, std::uint64_t seed, const std::string& folder, Progress& progress) {
  const auto shrunk = study::shrunk_soak(run, [&](std::size_t runs) {
    progress.tell("the smallest scenario of seed " + std::to_string(seed) + ": " + std::to_string(runs) + " tried");
  });
  if (!shrunk) {
    std::cerr << "As a scenario it does not fail: only the seed shows it.\n";
    return true;
  }
  const std::string path = (std::filesystem::path(folder) / ("soak-" + std::to_string(seed) + ".yaml")).string();
  if (const std::string problem = app::write_file(path, shrunk->text); !problem.empty())
    throw UsageError("--shrink: " + problem);
  std::cerr << in_words(shrunk->before) << " before, " << in_words(shrunk->after) << " now; " << shrunk->runs
            << " tried" << (shrunk->stopped ? ", and no more: it may not be the smallest" : "")
            << "\nthe smallest scenario: ringctl scenario run " << app::shell_word(path) << "\n";
  return study::is_small(shrunk->after);
}

/// If no seed that was asked for gives a small scenario, this many more broken seeds are tried.
constexpr std::uint64_t kMoreToShrink = 5;

/// The first seed of a range, drawn so that it has hardly been run before.
std::uint64_t fresh_range() {
  std::random_device device;
  return std::uniform_int_distribution<std::uint64_t>(1, 1'000'000'000'000)(device);
}

/// One seed after another, until all are done, enough are broken, or somebody asks it to end.
class Soak {
 public:
  explicit Soak(const SoakOptions& options) : options_(options) {}

  int run() {
    std::cerr << "Seeds " << options_.first << " to " << options_.first + options_.seeds - 1 << ".\n";
    bool goes_on = true;
    while (goes_on && tally_.seeds < options_.seeds && !interrupted_) goes_on = run_seed(options_.first + tally_.seeds);
    if (interrupted_) return say_interrupted();
    print();
    if (broken_ != 0) {
      std::cerr << broken_ << " of " << tally_.seeds << " seeds broke a promise.\n";
      return kBroken;
    }
    if (options_.format == app::Format::text) std::cout << "No promise was broken.\n";
    return options_.require_goals ? judge_goals() : kDone;
  }

 private:
  int judge_goals() const {
    const std::vector<std::size_t> never = never_met(tally_, options_);
    for (const std::size_t goal : never)
      std::cerr << "never met: " << sim::goals()[goal].name << ": " << sim::goals()[goal].sentence << '\n';
    return never.empty() ? kDone : kBroken;
  }

  /// @return false if enough are broken
  bool run_seed(std::uint64_t seed) {
    seeking_.learn(tally_, seed);
    const sim::Goal* goal = seeking_.goal_of(seed);
    study::RandomFaults::Origin origin{seed, options_.folding, world_for(goal, options_.world), options_.more};
    origin.more.sought = goal;
    study::RandomFaults faults(origin);
    faults.count_goals();
    std::optional<sim::Trace> trace;
    if (options_.hashes) trace.emplace(faults.ring());
    if (options_.shrink_into) faults.keep_history();
    interrupted_ = !faults.run([this] { return signals_->asked_to_end(std::chrono::milliseconds(0)); });
    if (interrupted_) return true;
    tally_.add(faults);
    if (trace) std::cout << "seed " << seed << " trace " << sim::hash_text(trace->hash()) << '\n';
    if (faults.violation()) return may_go_on_after(faults, seed);
    const std::string broken = broken_ == 0 ? "no promise broken" : std::to_string(broken_) + " broke a promise";
    progress_.tell(std::to_string(tally_.seeds) + " of " + std::to_string(options_.seeds) + " seeds, " + broken);
    return true;
  }

  bool may_go_on_after(const study::RandomFaults& faults, std::uint64_t seed) {
    std::cerr << violation_text(faults);
    if (options_.shrink_into) {
      signals_.reset();  // it may take long, and Ctrl-C ends it as ever
      small_ = write_shrunk(faults, seed, *options_.shrink_into, progress_) || small_;
      signals_.emplace();
    }
    return ++broken_ < options_.failures + (small_ || !options_.shrink_into ? 0 : kMoreToShrink);
  }

  int say_interrupted() const {
    print();
    std::cerr << "ring_sim: interrupted: " << tally_.seeds << " of " << options_.seeds << " seeds were run, " << broken_
              << " of them broke a promise\n";
    return kBroken;
  }

  void print() const {
    if (options_.format == app::Format::json)
      std::cout << tally_.row(options_).dump(2) << '\n';
    else
      std::cout << app::format_rows({tally_.row(options_)}, options_.format);
    if (options_.format == app::Format::text && broken_ == 0) std::cout << goals_text(tally_, options_);
  }

  const SoakOptions& options_;
  std::optional<process::SignalWait> signals_{std::in_place};
  Progress progress_;
  Tally tally_;
  Seeking seeking_{options_};
  std::uint64_t broken_ = 0;
  bool interrupted_ = false;
  bool small_ = false;  ///< a scenario that was made of one of them
};

constexpr std::int64_t kMostSeeds = 100'000'000;
constexpr std::uint64_t kLastSeed = std::numeric_limits<std::int64_t>::max();  ///< that a scenario takes

void add_seeds(CLI::App& command, SoakOptions& options) {
  command.add_option("--seeds", options.seeds, "Seeds to try, 1 to 100000000; default 1000")
      ->transform(cli::whole(1, kMostSeeds));
  command.add_option("--first", options.first, "The first seed, above 0; default: drawn at random, and printed")
      ->transform(cli::whole(1, static_cast<std::int64_t>(kLastSeed)));
  command.add_option("--failures", options.failures, "Stop after N broken seeds; default 1")
      ->transform(cli::whole(1, kMostSeeds));
}

void add_shrink(CLI::App& command, SoakOptions& options) {
  command
      .add_option(
          "--shrink", options.shrink_into,
          "Shrink each broken seed to the smallest scenario that fails in the same way, and write it into this "
          "folder (default: the current one) for 'ringctl scenario run'. If more than 3 faults or 10 sends are left, "
          "up to 5 more broken seeds follow. Only in the usual world")
      ->expected(0, 1)
      ->default_str(".");
}

void seek(const std::string& what, SoakOptions& options) {
  options.seek_unmet = options.seek_unmet || what == "unmet";
  if (what == "unmet") return;
  options.sought.push_back(read_goal(what));
}

void add_goals(CLI::App& command, SoakOptions& options) {
  command.add_flag("--goals", options.list_goals, "Print in how many seeds each goal was met, and how often");
  command.add_flag("--require-goals", options.require_goals,
                   "Exit with 1 if a goal was never met that this world can meet");
  command
      .add_option_function<std::vector<std::string>>(
          "--seek",
          [&options](const std::vector<std::string>& words) {
            for (const std::string& word : words) seek(word, options);
          },
          "Draw on purpose what meets these goals, in turn, in the least world that can. unmet: after each 100 seeds, "
          "every second seed seeks what no seed has met; which, is printed")
      ->delimiter(',');
}

/// Now, since a broken seed may come after hours. @throw UsageError
void require_writable(const std::string& folder) {
  const std::string problem = app::make_output_folder(folder);
  if (!problem.empty()) throw UsageError("--shrink: " + problem);
}

/// Refuses options that contradict each other. @throw UsageError
void check(const SoakOptions& options) {
  if (options.first > kLastSeed - (options.seeds - 1))
    throw UsageError("--first: the last of " + std::to_string(options.seeds) + " seeds from " +
                     std::to_string(options.first) + " on would be beyond it; " + std::to_string(kLastSeed) +
                     " is the last one that --first and a scenario take");
  if (options.shrink_into && options.world != study::WorldKind::usual)
    throw UsageError(
        "--shrink goes only with the usual world: a scenario has neither lines that differ nor sparse ids");
  if (options.seek_unmet && !options.sought.empty()) throw UsageError("--seek: either names of goals, or unmet");
  if (options.shrink_into && options.more.drift != 0)
    throw UsageError("--shrink: not of seeds whose clocks drift; leave --drift out");
  if (options.shrink_into && (options.seek_unmet || !options.sought.empty()))
    throw UsageError("--shrink: not of seeds that seek a goal; leave --seek out");
  if (options.list_goals && options.format != app::Format::text)
    throw UsageError("--goals prints lines of text: leave it out, --json has the goals");
  if (options.hashes && options.format != app::Format::text)
    throw UsageError("--hashes prints lines of text: leave --json and --csv out");
  if (options.shrink_into) require_writable(*options.shrink_into);
}

}  // namespace

void add_soak(CLI::App& app, Context& context) {
  auto options = std::make_shared<SoakOptions>();
  CLI::App* command =
      add_command(app, "soak", "Check all promises under random traffic and faults", "ring_sim soak --seeds 5000",
                  "Checks at every event, and stops at the first broken promise.");
  add_seeds(*command, *options);
  add_folding(*command, options->folding, "mixed: a third of the rings folds back (default); foldback: all of them");
  add_world(*command, options->world, options->more);
  add_shrink(*command, *options);
  add_goals(*command, *options);
  command->add_flag("--hashes", options->hashes, "Print the trace hash of every seed");
  add_format(*command, options->format);
  command->callback([&context, options] {
    context.action = [options] {
      if (options->first == 0) options->first = fresh_range();
      check(*options);
      return Soak(*options).run();
    };
  });
}

}  // namespace limb_ring::ring_sim
