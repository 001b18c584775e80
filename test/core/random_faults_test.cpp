// Whatever happens, each send has one result and it is true; nothing arrives twice, damaged or out
// of order; the ring heals and falls silent. LIMB_RING_SEED=n runs that one only, LIMB_RING_SEEDS=n
// runs so many.
#include <cstdlib>

#include "core/random_run.h"

namespace limb_ring::core {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::uint64_t kRuns = 60;  // some ten times slower
#else
constexpr std::uint64_t kRuns = 200;
#endif

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* value = std::getenv(name);
  return value ? std::strtoull(value, nullptr, 10) : otherwise;
}

TEST(RandomFaults, KeepEveryPromise) {
  const std::uint64_t first = from_environment("LIMB_RING_SEED", 1);
  const std::uint64_t count = from_environment("LIMB_RING_SEEDS", std::getenv("LIMB_RING_SEED") ? 1 : kRuns);
  std::array<unsigned, 7> ended{};
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    RandomRun run(seed);
    run.run();
    EXPECT_THAT(run.broken(), testing::IsEmpty()) << run.describe();
    for (unsigned outcome = 0; outcome < ended.size(); ++outcome)
      ended[outcome] += run.ended(static_cast<Outcome>(outcome));
  }
  // The mix reaches every way in which a send can end.
  if (count >= 50) {
    EXPECT_THAT(ended, testing::Each(testing::Gt(0u)));
  }
  std::cout << "sends by outcome: " << testing::PrintToString(ended) << '\n';
}

}  // namespace
}  // namespace limb_ring::core
