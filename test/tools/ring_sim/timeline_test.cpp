// Timelines of `ring_sim run --perfetto`: what ui.perfetto.dev needs so that it loads them without complaint.
#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "support/own_folder.h"
#include "tools/ring_sim/command_line.h"
#include "tools/ring_sim/run_ring_sim.h"

namespace limb_ring::ring_sim {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Timeline : public test::OwnFolder {
 protected:
  json events_of(const std::string& which, const std::string& nodes = "4") {
    const std::string path = folder + "/" + which + ".json";
    const CliRun run = ring_sim({"run", "--case", which, "--nodes", nodes, "--perfetto", path});
    EXPECT_EQ(run.code, kDone) << run.errors;
    return json::parse(std::ifstream(path)).at("traceEvents");
  }
  static json of_kind(const json& events, const std::string& kind) {
    json found = json::array();
    for (const json& event : events)
      if (event.at("ph") == kind) found.push_back(event);
    return found;
  }
};

TEST_F(Timeline, EachLineHasATrackWithItsName) {
  std::set<std::string> names;
  for (const json& event : of_kind(events_of("alone"), "M"))
    if (event.at("name") == "thread_name") names.insert(event.at("args").at("name"));
  EXPECT_EQ(names.size(), 4u);
  EXPECT_TRUE(std::all_of(names.begin(), names.end(), [](const std::string& n) { return n.find(" -> ") != n.npos; }));
}

TEST_F(Timeline, SlicesOfATrackLieBesideOrInsideEachOther) {
  std::map<int, std::vector<std::pair<double, double>>> open;  // by track: begin and end
  std::size_t slices = 0;
  for (const json& event : of_kind(events_of("adversarial", "16"), "X")) {
    const double begin = event.at("ts"), end = begin + event.at("dur").get<double>();
    auto& around = open[event.at("tid")];
    while (!around.empty() && around.back().second <= begin + 1e-6) around.pop_back();
    if (!around.empty()) {
      EXPECT_LE(end, around.back().second + 1e-6) << event;
    }
    around.emplace_back(begin, end);
    ++slices;
  }
  EXPECT_GT(slices, 100u);
}

TEST_F(Timeline, ArrowsLeadFromLineToLineAndEachBeginsAndEndsInsideASlice) {
  const json events = events_of("simultaneous");
  std::set<std::pair<int, double>> begins;
  for (const json& slice : of_kind(events, "X")) begins.emplace(slice.at("tid"), slice.at("ts"));
  std::map<int, int> steps;
  for (const char* kind : {"s", "t", "f"})
    for (const json& arrow : of_kind(events, kind)) {
      EXPECT_EQ(begins.count({arrow.at("tid"), arrow.at("ts")}), 1u) << arrow;
      ++steps[arrow.at("id")];
    }
  EXPECT_EQ(of_kind(events, "s").size(), of_kind(events, "f").size());
  EXPECT_GE(steps.size(), 4u);
  for (const auto& [id, count] : steps) EXPECT_EQ(count, 4) << id;  // once round
}

TEST_F(Timeline, InterruptsAreInstants) {
  const json instants = of_kind(events_of("interrupt"), "i");
  ASSERT_FALSE(instants.empty());
  EXPECT_THAT(instants[0].at("name").get<std::string>(), HasSubstr("INT"));
  EXPECT_EQ(instants[0].at("s"), "t");
}

TEST_F(Timeline, StandardOutputIsRefusedAndSoIsACaptureBeside) {
  EXPECT_THAT(ring_sim({"run", "--perfetto", "-"}).errors, HasSubstr("goes into a file"));
  EXPECT_THAT(ring_sim({"run", "--perfetto", folder + "/a", "--capture", folder + "/b"}).errors, HasSubstr("excludes"));
}

}  // namespace
}  // namespace limb_ring::ring_sim
