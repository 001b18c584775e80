// Core and specification do the same over random histories.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <random>

#include "model/compared_ring.h"
#include "sim/virtual_line_faults.h"
#include "study/random_faults.h"

namespace limb_ring::model {
namespace {

using study::RandomFaults;

std::optional<std::uint64_t> number(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr) return std::nullopt;
  return std::strtoull(text, nullptr, 10);
}

/// MODEL_WORLD: nothing if it is not set, or is not a world.
std::optional<RandomFaults::World> world_asked_for() {
  const char* text = std::getenv("MODEL_WORLD");
  for (std::size_t world = 0; text != nullptr && world < study::kWorldNames.size(); ++world)
    if (std::string(text) == study::kWorldNames[world]) return static_cast<RandomFaults::World>(world);
  EXPECT_EQ(text, nullptr) << "MODEL_WORLD is usual, wide, parts or storms";
  return std::nullopt;
}

struct Tally {
  unsigned histories = 0, folding = 0, parted = 0;
  std::uint64_t compared = 0;
};

/// Each third world is a wide one, if none is asked for, and about a third of the rings fold back.
void compare(std::uint64_t seed, Tally& tally, RandomFaults::FoldBack fold,
             std::optional<RandomFaults::World> world = {}) {
  using World = RandomFaults::World;
  RandomFaults run(seed, fold, world.value_or(seed % 3 == 0 ? World::wide : World::usual));
  ComparedRing compared(run.ring());
  run.run();
  const auto difference = compared.difference();
  ++tally.histories;
  if (run.folds_back()) ++tally.folding;
  tally.compared += compared.compared();
  if (!difference) return;
  ++tally.parted;
  ADD_FAILURE() << "seed " << seed << " (" << run.describe() << ")\n" << in_words(*difference);
}

/// Any value of a field of a CpuReport: one that nobody has written yet differs where the model does not know it.
template <class Below>
void set_odd(bool& is, const Below& below, core::Time) {
  is = below(2) == 0;
}
template <class Number, class Below>
std::enable_if_t<std::is_unsigned_v<Number>> set_odd(Number& number, const Below& below, core::Time) {
  number = below(2);
}
template <class Below>
void set_odd(wire::CpuState& state, const Below& below, core::Time) {
  state = static_cast<wire::CpuState>(below(6));
}
template <class Below>
void set_odd(core::Time& instant, const Below&, core::Time now) {
  instant = now;
}
template <class Below>
void set_odd(wire::ClockLatch& latch, const Below& below, core::Time) {
  latch.count = below(2);
}

/// CPUs that come, go, hang, say odd things and pull interrupt inputs, on a ring without faults.
void odd_calls(std::uint64_t seed, Tally& tally) {
  std::mt19937_64 random(seed);
  const auto below = [&](unsigned limit) { return static_cast<unsigned>(random() % limit); };
  sim::VirtualRingOptions options;
  options.nodes = 2 + below(4);
  options.byte_time = std::chrono::nanoseconds(below(2) == 0 ? 8 : 0);
  options.adjust = [](core::Settings& settings) {
    sim::set_short_times(settings, settings.byte_time_out.count() != 0, false);
    settings.inputs[1] = core::InterruptInput{wire::NodeId{1}, wire::Factor{2}};
    settings.inputs[2] = core::InterruptInput{wire::kBroadcast, wire::Factor{1}};
  };
  sim::VirtualRing ring(options);
  ComparedRing compared(ring);
  for (unsigned step = 0; step < 400; ++step) {
    const wire::NodeId id{static_cast<std::uint8_t>(below(options.nodes))};
    const wire::NodeId to{static_cast<std::uint8_t>(below(8) == 0 ? 0xFF : below(options.nodes + 1))};
    core::CpuReport report;
    core::CpuReport::fields([&](const char*, auto member, auto, bool) { set_odd(report.*member, below, ring.now()); });
    switch (below(8)) {
      case 0:
        ring.node(id).apply(core::input::Cpu{report}, ring.now());
        break;
      case 1:
        ring.set_cpu_present(id, below(2) == 0);
        break;
      case 2:
        ring.pull(id, below(10));
        break;
      case 3:
        ring.interrupt(id, to, static_cast<std::uint8_t>(below(10)));
        break;
      case 4:
        below(2) == 0 ? ring.reset_cpu(id) : ring.cancel(id);
        break;
      default:
        ring.send(id, to, std::vector<std::uint8_t>(below(514)), static_cast<std::uint8_t>(below(5)),
                  static_cast<std::uint8_t>(below(66)));
    }
    ring.run_for(core::Duration{std::chrono::nanoseconds(1)} * below(20000));
  }
  ring.run_for(std::chrono::milliseconds(5));
  ++tally.histories;
  tally.compared += compared.compared();
  if (const auto difference = compared.difference()) ADD_FAILURE() << "seed " << seed << "\n" << in_words(*difference);
}

TEST(Model, aCoreDoesWhatTheSpecificationSaysOfOddCalls) {
  Comparison::trace = number("MODEL_TRACE").value_or(0);
  std::uint64_t seed = number("MODEL_FIRST").value_or(std::random_device{}());
  std::cout << "seeds from " << seed << " on\n";
  Tally tally;
  for (unsigned run = 0; run < 20 && !HasFailure(); ++run) odd_calls(seed++, tally);
  EXPECT_GT(tally.compared, 1000u);
}

// What these have shown once stays so. (What it was stands in the history of docs/protocol.md.)
TEST(Model, aCoreDoesWhatTheSpecificationSaysInHistoriesThatOnceShowedSomething) {
  Tally tally;
  for (const std::uint64_t seed :
       {4, 10, 16, 17, 19, 20, 30, 35, 70, 74, 111, 124, 210, 393, 504, 508, 1061, 1078, 510615, 521140, 1938716889})
    compare(seed, tally, RandomFaults::FoldBack::some);
  // Rings that fold back.
  for (const std::uint64_t seed : {12, 28, 38, 45, 48, 130, 132, 136, 222, 315, 322, 11136, 500358, 510237, 510680,
                                   510759, 521588, 600237, 2001000147})
    compare(seed, tally, RandomFaults::FoldBack::some);
  // Where all are to fold back.
  for (const std::uint64_t seed : {21030, 21075, 41092, 41098}) compare(seed, tally, RandomFaults::FoldBack::all);
  // Rings that fall into parts.
  for (const std::uint64_t seed : {700115l, 700273l, 2001000048l, 2001000117l, 509497814052l, 43043202304l})
    compare(seed, tally, RandomFaults::FoldBack::some, RandomFaults::World::parts);
  for (const std::uint64_t seed : {5200001049, 5300000396, 63282486801, 63282487000, 509497835283})
    compare(seed, tally, RandomFaults::FoldBack::some, RandomFaults::World::storms);
  // A send into an open chain ends as it leaves; a beacon that follows says what was known then, not what comes next.
  for (const std::uint64_t seed : {745543243013, 745543243157, 63282411701, 935847414367})
    compare(seed, tally, RandomFaults::FoldBack::some, RandomFaults::World::usual);
  compare(499610330563, tally, RandomFaults::FoldBack::some, RandomFaults::World::wide);
}

// MODEL_SEEDS=N runs so many, MODEL_FIRST=N from that one on, MODEL_FOLD=1 on rings that all fold back,
// MODEL_WORLD=parts in that world of soak, MODEL_SECONDS=N until they are over. Without them a few that are known to
// agree.
TEST(Model, aCoreDoesWhatTheSpecificationSaysInRandomHistories) {
  Comparison::trace = number("MODEL_TRACE").value_or(0);
  const std::uint64_t first = number("MODEL_FIRST").value_or(400), seeds = number("MODEL_SEEDS").value_or(20);
  const auto fold = number("MODEL_FOLD") ? RandomFaults::FoldBack::all : RandomFaults::FoldBack::some;
  const auto world = world_asked_for();
  const auto until =
      std::chrono::steady_clock::now() + std::chrono::seconds(number("MODEL_SECONDS").value_or(1'000'000));
  Tally tally;
  for (std::uint64_t seed = first; seed < first + seeds && tally.parted < 5; ++seed) {
    if (std::chrono::steady_clock::now() >= until) break;
    compare(seed, tally, fold, world);
  }
  std::cout << tally.histories << " histories of seeds from " << first << " on, of which " << tally.folding
            << " fold back, " << tally.compared << " outputs compared, " << tally.parted << " histories parted\n";
}

}  // namespace
}  // namespace limb_ring::model
