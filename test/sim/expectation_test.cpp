// Each kind of expectation, met and unmet, and how it is reported. Four nodes at 1 Gbit/s, d = 512 ns: a packet of
// 512 bytes is home after T + N d = 4.192 + 2.048 = 6.24 us.
#include "sim/scenario_text.h"

namespace limb_ring::scenario {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kSent = "steps:\n  - {at: 10ms, do: {send: {name: x, from: node0, to: node2, size: 512}}}\n";

std::string when(const std::string& condition, const std::string& within) {
  return "  - {when: " + condition + ", within: " + within + "}\n";
}

TEST(Expectation, IsMetInTimeAndNotANanosecondEarlier) {
  EXPECT_EQ(unmet_of(kSent + when("{results: x, are: delivered, at_least: 1}", "6240ns")), "");
  EXPECT_EQ(unmet_of(kSent + when("{results: x, are: delivered, at_least: 1}", "6239ns")),
            "when {results: x, are: delivered, at_least: 1} within 6239ns; nothing of it");
}

TEST(Expectation, OfLatency) {
  const std::string done = kSent + when("{results: x, are: delivered, at_least: 1}", "1ms");
  EXPECT_EQ(unmet_of(done + "always: [{latency: x, at_most: 6240ns}]\n"), "");
  EXPECT_EQ(unmet_of(done + "always: [{latency: x, at_most: 6239ns}]\n"),
            "always {latency: x, at_most: 6239ns}; 6240ns");
}

TEST(Expectation, OfLatencyIsUnmetIfNoneWasConfirmed) {
  const std::string lost = "steps:\n  - {at: 1ms, do: {kill: node2}}\n" + kSent.substr(kSent.find("  -"));
  EXPECT_EQ(unmet_of(lost + when("{latency: x, at_most: 1s}", "100ms")),
            "when {latency: x, at_most: 1s} within 100ms; none was confirmed");
  EXPECT_EQ(unmet_of(lost + "  - {after: 100ms}\nalways: [{latency: x, at_most: 1ns}]\n"), "");
  EXPECT_EQ(unmet_of(kSent + "  - {after: 1ms}\nnever: [{latency: x, at_most: 1us}]\n"), "");
  EXPECT_EQ(unmet_of(kSent + "  - {after: 1ms}\nnever: [{latency: x, at_most: 1ms}]\n"),
            "never {latency: x, at_most: 1ms}; 6240ns");
}

TEST(Expectation, OfWhatWasTaken) {
  EXPECT_EQ(unmet_of(kSent + when("{taken: x, at_least: 1}", "1ms")), "");
  EXPECT_EQ(unmet_of(kSent + when("{taken: x, at_least: 2}", "1ms")), "when {taken: x, at_least: 2} within 1ms; 1");
}

TEST(Expectation, OfACounter) {
  EXPECT_EQ(unmet_of("steps: [{at: 1s}]\nalways: [{counter: crc_errors, of: all, at_most: 0}]\n"), "");
  EXPECT_EQ(unmet_of(kSent + "  - {after: 1ms}\nnever: [{counter: received_data, of: node2, at_least: 1}]\n"),
            "never {counter: received_data, of: node2, at_least: 1}; 1");
}

TEST(Expectation, OfAState) {
  EXPECT_EQ(unmet_of("steps: []\nalways: [{node: all, is: up, ring_size: 4}]\n"), "");
  EXPECT_EQ(unmet_of("steps: [{at: 1ms, do: {kill: node3}}, {after: 1ms}]\nalways: [{node: all, is: up}]\n"),
            "always {node: all, is: up}; node3 is down");
}

TEST(Expectation, OfLivingNodesIsUnmetIfNoneLives) {
  const std::string nobody = "steps:\n  - {at: 1ms, do: {kill: all}}\n";
  EXPECT_EQ(unmet_of(nobody + when("{node: living, is: up}", "1ms")),
            "when {node: living, is: up} within 1ms; no node is alive");
  EXPECT_EQ(unmet_of(nobody + when("{cpu: node0, is: running}", "1ms")),
            "when {cpu: node0, is: running} within 1ms; no other node is alive");
  EXPECT_EQ(unmet_of(nobody + when("{node: all, is: down}", "1ms")), "");
}

TEST(Expectation, OfACpu) {
  EXPECT_EQ(unmet_of("steps:\n" + when("{cpu: node1, is: running, boots: 1}", "1ms")), "");
  EXPECT_EQ(unmet_of("steps:\n" + when("{cpu: node1, is: silent}", "200ms")),
            "when {cpu: node1, is: silent} within 200ms; node0 has heard that it is running in boot 1");
}

TEST(Expectation, OfALocatedBreak) {
  EXPECT_EQ(
      unmet_of("steps:\n" + when("{located: node0 -> node1}", "300ms")),
      "when {located: node0 -> node1} within 300ms; node0 does not know; node2 does not know; node3 does not know");
}

TEST(Expectation, IsUnmetIfAStepIsTooLate) {
  EXPECT_THAT(unmet_of("steps:\n  - {at: 1ms, do: {cut: node0 -> node1}}\n" +
                       when("{node: all, is: open_chain}", "1s") + "  - {at: 2ms}\n"),
              StartsWith("a step that is in time"));
}

TEST(Expectation, NothingIsDoneAfterTheFirstThatIsUnmet) {
  const ScenarioRun run = run_of("steps:\n" + when("{node: node0, is: down}", "1ms") + "  - {do: {kill: node0}}\n");
  ASSERT_TRUE(run.unmet);
  EXPECT_EQ(run.lasted, std::chrono::milliseconds(1));
  EXPECT_THAT(text_of(run), AllOf(HasSubstr("test.yaml: a test (seed 1)"), HasSubstr("1.000000 ms  NOT as expected"),
                                  HasSubstr("seen instead: node0 is up"), testing::Not(HasSubstr("do {kill"))));
}

TEST(Expectation, TheSameSeedGivesTheSameRun) {
  const std::string noise =
      "seed: 3\nsteps:\n  - {do: {corrupt: {line: node0 -> node1, once_in: 3}}}\n"
      "  - {do: {send: {name: x, from: all, to: all, size: 64, every: 50us, count: 50}}}\n" +
      when("{results: x, are: delivered, at_least: 200}", "100ms");
  EXPECT_EQ(text_of(run_of(noise)), text_of(run_of(noise)));
}

TEST(Junit, HasACasePerScenarioWithWhatWasExpectedAndSeen) {
  const ScenarioRun good = run_of("steps: [{at: 2ms}]\n");
  const ScenarioRun bad = run_of("steps:\n" + when("{located: node0 -> node1}", "1ms"));
  EXPECT_THAT(
      junit_of({good, bad}),
      AllOf(StartsWith("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n"),
            HasSubstr("tests=\"2\" failures=\"1\" errors=\"0\" skipped=\"0\" time=\"0.003000000\""),
            HasSubstr("<testcase classname=\"scenarios\" name=\"test: a test\" time=\"0.002000000\">"),
            HasSubstr("<failure message=\"expected: when {located: node0 -&gt; node1} within 1ms; seen: node0 does")));
}

TEST(Junit, NamesWhatWasNotRun) {
  const auto named = [](const std::string& name) {
    return parse_scenario("scenario: " + name + "\nnodes: 4\nsteps: [{at: 2ms}]\n", "night.yaml");
  };
  EXPECT_THAT(junit_of({run_of("steps: [{at: 2ms}]\n")}, {named("one"), named("two"), named("three")}, "a < b"),
              AllOf(HasSubstr("tests=\"3\" failures=\"0\" errors=\"1\" skipped=\"1\" time=\"0.002000000\""),
                    HasSubstr("name=\"night: two\" time=\"0.000000000\">\n      <error message=\"a &lt; b\"/>\n"),
                    HasSubstr("name=\"night: three\" time=\"0.000000000\">\n      <skipped message=\"not run\"/>")));
}

}  // namespace
}  // namespace limb_ring::scenario
