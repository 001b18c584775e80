// Scenarios are refused if they ask for something that no live daemon can do, and only then.
#include "sim/scenario_report.h"

#include "sim/scenario_text.h"

namespace limb_ring::scenario {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> reasons(const std::string& more, const std::string& transport = "") {
  return only_virtual(parse_scenario(four_nodes(more), "test.yaml"), transport);
}

const std::string kSmallSend = "  - do: {send: {name: x, from: node0, to: node2, size: 8}}\n";

TEST(OnlyVirtual, NothingInAnOrdinaryScenario) {
  EXPECT_THAT(reasons("steps:\n  - {at: 10ms, do: {cut: node0 -> node1}}\n" + kSmallSend +
                      "  - {when: {results: x, are: delivered, at_least: 1}, within: 1ms}\n"),
              IsEmpty());
}

TEST(OnlyVirtual, StepsCloserThanAMillisecond) {
  EXPECT_THAT(reasons("steps: [{after: 6us, do: {kill: node3}}]\n"), ElementsAre(HasSubstr("after: 6us")));
  EXPECT_THAT(reasons("steps: [{after: 1ms, do: {kill: node3}}]\n"), IsEmpty());
}

TEST(OnlyVirtual, SendsThatAResetCancels) {
  const std::string cancelled = "[{results: x, are: cancelled, at_least: 1}]\n";
  EXPECT_THAT(reasons("steps:\n" + kSmallSend + "never: " + cancelled), ElementsAre(HasSubstr("outlive a reset")));
}

TEST(OnlyVirtual, EmbeddingOnLinesThatTakeNoTime) {
  EXPECT_THAT(reasons("steps: []\nnever: [{counter: embedded_interrupts, of: all, at_least: 1}]\n"),
              ElementsAre(HasSubstr("embedded_interrupts")));
}

TEST(OnlyVirtual, ReorderOnAStreamButNotOverUdp) {
  const std::string reorder = "steps: [{do: {reorder: {line: node0 -> node1, packets: 1}}}]\n";
  EXPECT_THAT(reasons(reorder),
              ElementsAre(HasSubstr("UNIX streams and shared memory keep order; with --transport udp")));
  EXPECT_THAT(reasons(reorder, "udp"), IsEmpty());
}

TEST(OnlyVirtual, ClocksThatAreSetButNotAHostThatIsSuspended) {
  EXPECT_THAT(reasons("steps: [{do: {step_clock: node1 back=1s}}]\n"),
              ElementsAre(HasSubstr("live, the clocks are those of the machine")));
  EXPECT_THAT(reasons("steps: [{do: {suspend: node1}}]\n"), IsEmpty());
}

TEST(OnlyVirtual, WhatItsAuthorSays) {
  EXPECT_THAT(reasons("only: sim\nsteps: []\n"), ElementsAre("only: sim"));
  EXPECT_THAT(refusal_of(four_nodes("only: live\nsteps: []\n")), HasSubstr("entry 'only'"));
}

}  // namespace
}  // namespace limb_ring::scenario
