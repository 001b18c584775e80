#include "app/ringctl/live/play_live.h"

#include "app/ringctl/live/live_stage.h"
#include "app/ringctl/live/story_ring.h"
#include "bench/private_folder.h"

namespace limb_ring::ringctl {

scenario::ScenarioRun play_live(const scenario::Scenario& scenario, std::uint64_t seed,
                                       const std::string& transport) {
  const bench::PrivateFolder folder;
  const RingPlan plan = plan_story_ring(scenario, folder.path(), transport);
  SignalWait signals;
  LiveStage stage(scenario, seed, plan, signals);
  return run_scenario(scenario, seed, stage);
}

}  // namespace limb_ring::ringctl
