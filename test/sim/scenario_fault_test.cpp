// Each fault, by what the ring shows of it. Four nodes at 1 Gbit/s, d = 512 ns; time-out of a try 100 ms, bypass
// grace 200 ms, both the defaults.
#include "sim/scenario_text.h"

namespace limb_ring::scenario {
namespace {

const std::string kSend = "  - do: {send: {name: x, from: node0, to: node2, size: 512}}\n";

// A quiet start: what nodes say when they join is over.
std::string after_joining(const std::string& fault, const std::string& more) {
  return "steps:\n  - {at: 10ms, do: " + fault + "}\n" + more;
}

TEST(Faults, CutIsLocatedAfterTheGraceAndHealedAgain) {
  EXPECT_EQ(unmet_of(after_joining("{cut: node1 -> node2}",
                                   "  - {after: 199ms, when: {node: all, is: up}, within: 0s}\n"
                                   "  - {when: {located: node1 -> node2}, within: 2ms}\n"
                                   "  - {do: {heal: node1 -> node2}}\n"
                                   "  - {when: {node: all, is: up}, within: 210ms}\n")),
            "");
}

// T + N d = 4.192 + 2.048 us would be an undisturbed round trip; a lost try costs 100 ms.
TEST(Faults, DropCostsATimeOut) {
  EXPECT_EQ(unmet_of(after_joining(
                "{drop: {line: node0 -> node1, packets: 1}}",
                kSend + "  - {when: {results: x, are: delivered, at_least: 1}, within: 101ms}\n"
                        "  - {when: {counter: timeouts, of: node0, at_least: 1, at_most: 1}, within: 0s}\n")),
            "");
}

TEST(Faults, DropForATimeEndsByItself) {
  EXPECT_EQ(unmet_of(after_joining("{drop: {line: node0 -> node1, for: 1ms}}",
                                   "  - after: 1ms\n"
                                   "    do: {send: {name: x, from: node0, to: node2, size: 512}}\n"
                                   "  - {when: {results: x, are: delivered, at_least: 1}, within: 7us}\n")),
            "");
}

// Home damaged after 6.24 us, and once more: 12.48 us.
TEST(Faults, CorruptIsCountedBehindTheLineAndSentAgain) {
  EXPECT_EQ(unmet_of(after_joining("{corrupt: {line: node0 -> node1, packets: 1}}",
                                   kSend + "  - {when: {results: x, are: delivered, at_least: 1}, within: 12481ns}\n"
                                           "  - {when: {counter: crc_errors, of: node1, at_least: 1}, within: 0s}\n")),
            "");
}

TEST(Faults, TruncateIsAnAbortOnTheLine) {
  EXPECT_EQ(
      unmet_of(after_joining("{truncate: {line: node0 -> node1, packets: 1}}",
                             kSend + "  - {when: {counter: aborts_received, of: node1, at_least: 1}, within: 6us}\n"
                                     "  - {when: {taken: x, at_least: 1}, within: 101ms}\n")),
      "");
}

// Its CPU has gone since: no buffer of it is free, and the answer is that the packet was taken.
TEST(Faults, ARetryOfWhatACrashedCpuHasTakenIsConfirmed) {
  EXPECT_EQ(unmet_of(after_joining("{drop: {line: node3 -> node0, packets: 1}}",
                                   kSend + "  - {after: 1ms, do: {crash: node2}}\n"
                                           "  - {when: {results: x, are: delivered, at_least: 1}, within: 101ms}\n"
                                           "  - {when: {taken: x, at_least: 1, at_most: 1}, within: 0s}\n")),
            "");
}

TEST(Faults, KillAndStart) {
  EXPECT_EQ(unmet_of(after_joining("{kill: node3}",
                                   "  - {when: {node: node3, is: down}, within: 0s}\n"
                                   "  - {when: {node: living, ring_size: 3}, within: 110ms}\n"
                                   "  - {do: {start: node3}}\n"
                                   "  - {when: {node: all, is: up, ring_size: 4}, within: 110ms}\n")),
            "");
}

// A second one has no end of its own.
TEST(Faults, WhatTakesThePlaceOfOneThatLastsForATimeDoesNotEndWithIt) {
  for (const char* again : {"  - {at: 110ms, do: {thaw: node3}}\n  - {at: 120ms, do: {freeze: node3}}\n",
                            "  - {at: 110ms, do: {freeze: node3}}\n",
                            "  - {at: 110ms, do: {kill: node3}}\n  - {at: 120ms, do: {start: node3}}\n"
                            "  - {at: 130ms, do: {freeze: node3}}\n"})
    EXPECT_EQ(unmet_of(after_joining("{freeze: {nodes: node3, for: 1s}}",
                                     std::string(again) + "  - {at: 2s, when: {node: node3, is: down}, within: 0s}\n")),
              "");
  EXPECT_EQ(unmet_of(after_joining("{hang: {nodes: node3, for: 1s}}",
                                   "  - {at: 110ms, do: {resume: node3}}\n"
                                   "  - {at: 120ms, do: {hang: node3}}\n"
                                   "  - {at: 2s, when: {cpu: node3, is: silent}, within: 0s}\n")),
            "");
}

TEST(Faults, FreezeAndThaw) {
  EXPECT_EQ(unmet_of(after_joining("{freeze: node3}",
                                   "  - {when: {node: node3, is: down}, within: 0s}\n"
                                   "  - {after: 1s, do: {thaw: node3}}\n"
                                   "  - {when: {node: all, is: up, ring_size: 4}, within: 110ms}\n")),
            "");
}

TEST(Faults, PowerCycleIsANewStart) {
  EXPECT_EQ(unmet_of(after_joining("{power_cycle: node3}",
                                   "  - {when: {counter: hellos, of: node3, at_least: 1, at_most: 1}, within: 1ms}\n"
                                   "  - {when: {node: all, is: up, ring_size: 4}, within: 110ms}\n")),
            "");
}

// A CPU that hangs sends nothing and takes nothing; its 32 buffers are there, so packets are delivered.
TEST(Faults, HangAndResume) {
  EXPECT_EQ(
      unmet_of(after_joining("{hang: node2}", "  - {when: {cpu: node2, is: silent}, within: 601ms}\n" + kSend +
                                                  "  - {when: {results: x, are: delivered, at_least: 1}, within: 7us}\n"
                                                  "  - {when: {taken: x, at_most: 0}, within: 0s}\n"
                                                  "  - {do: {resume: node2}}\n"
                                                  "  - {when: {taken: x, at_least: 1}, within: 1us}\n")),
      "");
}

TEST(Faults, ResetIsASecondBoot) {
  EXPECT_EQ(unmet_of(after_joining("{reset: node2}",
                                   "  - {when: {cpu: node2, is: booting, boots: 1}, within: 1ms}\n"
                                   "  - {when: {cpu: node2, is: running, boots: 2}, within: 21ms}\n")),
            "");
}

TEST(Faults, NotReadingFillsTheBuffers) {
  EXPECT_EQ(
      unmet_of(after_joining("{not_reading: node2}",
                             "  - {do: {send: {name: x, from: node0, to: node2, size: 8, count: 40}}}\n"
                             "  - {when: {results: x, are: refused, at_least: 1}, within: 1100ms}\n"
                             "  - {when: {results: x, are: delivered, at_least: 32, at_most: 32}, within: 0s}\n")),
      "");
}

// A hang that is over leaves the CPU as slow, and as talkative, as it was.
TEST(Faults, OneThatIsOverEndsNoOther) {
  EXPECT_EQ(
      unmet_of(after_joining("{not_reading: node2}", "  - {do: {hang: {nodes: node2, for: 1s}}}\n" + kSend +
                                                         "  - {after: 2s, when: {taken: x, at_most: 0}, within: 0s}\n"
                                                         "  - {do: {resume: node2}}\n"
                                                         "  - {when: {taken: x, at_least: 1}, within: 1us}\n")),
      "");
  EXPECT_EQ(
      unmet_of(after_joining("{babble: node2 every=1ms}",
                             "  - {do: {hang: {nodes: node2, for: 1s}}}\n"
                             "  - {after: 2s, when: {counter: sent_data, of: node2, at_least: 900}, within: 0s}\n"
                             "  - {do: {resume: node2}}\n"
                             "  - {after: 2s, when: {counter: sent_data, of: node2, at_most: 1200}, within: 0s}\n")),
      "");
}

TEST(Faults, ASecondBabbleTakesThePlaceOfTheFirst) {
  EXPECT_EQ(
      unmet_of(after_joining("{babble: node2 every=1ms}",
                             "  - {do: {babble: node2 every=10ms}}\n"
                             "  - {after: 1s, when: {counter: sent_data, of: node2, at_most: 200}, within: 0s}\n")),
      "");
}

TEST(Faults, AMuteCpuReadsAndAsksForNothingUntilItIsOver) {
  const std::string said = "  - do: {send: {name: y, from: node2, to: node0, size: 8}}\n";
  EXPECT_EQ(unmet_of(after_joining("{mute: {nodes: node2, for: 1s}}",
                                   kSend + said +
                                       "  - {when: {taken: x, at_least: 1}, within: 7us}\n"
                                       "  - {after: 500ms, when: {taken: y, at_most: 0}, within: 0s}\n"
                                       "  - after: 1s\n    " +
                                       said.substr(4) + "  - {when: {taken: y, at_least: 1}, within: 7us}\n")),
            "");
}

TEST(Faults, ACpuThatIsResumedWhileItBootsTakesPacketsOnceItHasBooted) {
  EXPECT_EQ(unmet_of(after_joining("{reset: node2}",
                                   "  - {after: 5ms, do: {resume: node2}}\n"
                                   "  - {when: {cpu: node2, is: running, boots: 2}, within: 1s}\n" +
                                       kSend +
                                       "  - {when: {results: x, are: delivered, at_least: 1}, "
                                       "within: 1s}\n")),
            "");
}

}  // namespace
}  // namespace limb_ring::scenario
