#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using ::testing::AllOf;
using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// What is added to two_nodes() begins in line 6.

TEST(WrongEntry, IsNamedWithFilePlaceValueAndWhatIsAllowed) {
  EXPECT_THAT(refusal_of(two_nodes("timeouts:\n  send: 12 parsec\n")),
              Eq("ring.yaml:7:9: entry 'timeouts.send': '12 parsec' is not a time; allowed: a time "
                 "such as 100ms, 1ms to 60s"));
}

TEST(WrongEntry, IsNotTheOnlyOneAndAllAreNamedAtOnce) {
  const std::string text =
      "ring: two words\ncolour: red\ntimeouts: {send: 12 parsec, idel: 1s}\n"
      "nodes:\n  - {id: 0, name: all, joints: [{name: a, lower: low}, {name: a, safe: float}]}\n"
      "  - {name: b}\n  - {id: 0, cpu: some}\n"
      "supervisor: {node: b}\ntraffic: [{name: s, from: c, to: all, size: 0, rate: 1}]\n";
  const std::string all = refusal_of(text);
  for (const char* problem : {"ring.yaml:1:7: entry 'ring'", "ring.yaml:2:1: entry 'colour'", "entry 'timeouts.send'",
                              "entry 'timeouts.idel'", "entry 'nodes[0].name'", "'nodes[0].joints[0].lower'",
                              "'nodes[0].joints[1].safe'", "'nodes[0].joints[1]': 'a' is the name of another one",
                              "entry 'nodes[1]': 'id' is missing", "'nodes[2].cpu'", "entry 'traffic[0].size'"})
    EXPECT_THAT(all, HasSubstr(problem));
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 10) << all;
  EXPECT_THAT(all, ::testing::Not(HasSubstr("supervisor.node"))) << "nobody knows all nodes";
  EXPECT_THAT(refusal_of(two_nodes("bridge: {topics: [{input: a, from: 0, to: 1}, {input: a, from: 0, to: 1}]}\n"
                                   "timeouts: {idle: 1s}\n")),
              AllOf(HasSubstr("entry 'timeouts.idle'"), HasSubstr("entry 'bridge.topics[1]'")));
}

TEST(WrongEntry, IsListedOnlyUpToALimit) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += "unknown" + std::to_string(i) + ": 1\n";
  EXPECT_THAT(refusal_of(two_nodes(text)),
              AllOf(HasSubstr("unknown48"), ::testing::EndsWith("\nThere are more problems than these.")));
}

TEST(WrongEntry, UnknownAtTheTop) {
  EXPECT_THAT(
      refusal_of(two_nodes("timeout: {}\n")),
      AllOf(
          StartsWith("ring.yaml:6:1: entry 'timeout': is unknown, did you mean 'timeouts'?"),
          HasSubstr(
              "; allowed: ring, redundancy, limits, timeouts, links, firmware, realtime, urdf, hosts, recorder, nodes, "
              "supervisor, virtual, bridge, traffic")));
}

TEST(WrongEntry, OfAScenarioSaysSo) {
  EXPECT_THAT(
      refusal_of("scenario: a wire breaks\nring: leg8.yaml\nsteps: []\n"),
      Eq("ring.yaml:1:11: entry 'scenario': this is a scenario, not the file of a ring; allowed: 'ringctl scenario "
         "run FILE' for a scenario"));
  EXPECT_THAT(refusal_of("nodes: 4\nnever: []\n"), HasSubstr("entry 'never': this is a scenario"));
}

TEST(WrongEntry, UnknownWithinASection) {
  EXPECT_THAT(refusal_of(two_nodes("limits: {send_que: 3}\n")),
              AllOf(StartsWith("ring.yaml:6:10: entry 'limits.send_que': is unknown, did you mean "
                               "'send_queue'?"),
                    HasSubstr("allowed: insertion_buffer, ")));
  EXPECT_THAT(refusal_of(two_nodes("firmware: {colour: red}\n")),
              StartsWith("ring.yaml:6:12: entry 'firmware.colour': is unknown; allowed: state_rate"));
}

TEST(WrongEntry, ForControllersInLockstep) {
  EXPECT_THAT(
      refusal_of(two_nodes("bridge: {lockstep: arms}\n")),
      AllOf(StartsWith("ring.yaml:6:20: entry 'bridge.lockstep': 'arms' is unknown"), HasSubstr("a list of up to 16")));
  EXPECT_THAT(refusal_of(two_nodes("bridge: {lockstep: [arms, arms]}\n")), HasSubstr("'arms' is listed twice"));
  EXPECT_THAT(refusal_of(two_nodes("bridge: {lockstep: [{}]}\n")), HasSubstr("entry 'bridge.lockstep[0]'"));
}

TEST(WrongEntry, ThatWasReplacedByThreeNamesThem) {
  EXPECT_THAT(
      refusal_of(two_nodes("timeouts: {bypass: 200ms}\n")),
      Eq("ring.yaml:6:20: entry 'timeouts.bypass': has been replaced by three entries; allowed: first_successor, "
         "break_grace, fold_permission"));
}

TEST(WrongEntry, GivenTwice) {
  EXPECT_THAT(refusal_of(two_nodes("bridge: {}\nbridge: {}\n")),
              Eq("ring.yaml:7:1: entry 'bridge': is given twice; allowed: once"));
}

TEST(WrongEntry, TheMergeKeyIsNotSupportedAndAnAliasIs) {
  const std::string merge = "{<<: *longer, send: 200ms}";
  EXPECT_THAT(refusal_of(two_nodes("timeouts: &longer {send: 200ms}\nbridge: " + merge + "\n")),
              Eq("ring.yaml:7:10: entry 'bridge.<<': is YAML's merge key, which is not supported; allowed: the entries "
                 "themselves; an anchor and its alias (&name, *name) for a whole value"));
  EXPECT_THAT(refusal_of("ring: pair\nnodes:\n  - &limb {id: 0}\n  - {<<: *limb, id: 1}\n"),
              StartsWith("ring.yaml:4:6: entry 'nodes[1].<<': is YAML's merge key"));
  EXPECT_EQ(refusal_of("ring: pair\nnodes:\n  - {id: 0, cpu: &same attached}\n  - {id: 1, cpu: *same}\n"), "");
}

TEST(WrongEntry, AValueWhereAMapIsExpected) {
  EXPECT_THAT(refusal_of(two_nodes("limits: 7\n")),
              StartsWith("ring.yaml:6:9: entry 'limits': '7' is not a map (name: value); allowed: a map "
                         "of insertion_buffer"));
  EXPECT_THAT(refusal_of(two_nodes("limits: [7]\n")), HasSubstr("'limits': a list is not a map"));
  EXPECT_THAT(refusal_of(two_nodes("limits:\n")), HasSubstr("'limits': nothing is not a map"));
}

TEST(WrongEntry, AMapOrAListWhereAValueIsExpected) {
  EXPECT_THAT(refusal_of(two_nodes("limits: {clients: [1]}\n")),
              HasSubstr("'limits.clients': a list stands here; allowed: a whole number, 1 to 1024"));
  EXPECT_THAT(refusal_of(two_nodes("limits: {clients: {a: 1}}\n")), HasSubstr("a map stands here"));
  EXPECT_THAT(refusal_of(two_nodes("limits: {clients: }\n")), HasSubstr("nothing stands here"));
}

TEST(WrongEntry, AListWithinTheNameOfAnEntry) {
  EXPECT_THAT(refusal_of(two_nodes("limits: {[1]: 2}\n")), HasSubstr("a list stands here; allowed: a plain name"));
}

TEST(WrongEntry, TimeOutOfRangeOrWithoutUnitOrTooFine) {
  EXPECT_THAT(refusal_of(two_nodes("timeouts: {send: 61s}\n")),
              HasSubstr("'61s' is out of range; allowed: a time such as 100ms, 1ms to 60s"));
  EXPECT_THAT(refusal_of(two_nodes("timeouts: {send: 100}\n")), HasSubstr("'100' has no unit (ns, us, ms or s)"));
  EXPECT_THAT(refusal_of(two_nodes("timeouts: {send: 1500us}\n")),
              AllOf(HasSubstr("'1500us' is too fine"), HasSubstr("in steps of 1ms")));
}

TEST(WrongEntry, NumberOutOfRangeOrNotANumber) {
  EXPECT_THAT(refusal_of(two_nodes("limits: {insertion_buffer: 1}\n")),
              HasSubstr("'1' is out of range; allowed: a whole number, 2 to 1024"));
  EXPECT_THAT(refusal_of(two_nodes("limits: {clients: 2.5}\n")), HasSubstr("'2.5' is not a whole number"));
  EXPECT_THAT(refusal_of(two_nodes("firmware: {bandwidth: nan}\n")),
              HasSubstr("'nan' is not a number; allowed: a number, 0.1 to 100 Hz"));
  EXPECT_THAT(refusal_of(two_nodes("firmware: {bandwidth: 1000}\n")), HasSubstr("is out of range"));
}

TEST(WrongEntry, RateTransportAddressAndPort) {
  EXPECT_THAT(refusal_of(two_nodes("links: {rate: fast}\n")),
              HasSubstr("'links.rate': 'fast' is not a rate; allowed: a rate such as 10Mbit/s"));
  EXPECT_THAT(refusal_of(two_nodes("links: {rate: 0}\n")),
              AllOf(HasSubstr("'0' is out of range"), HasSubstr("or unlimited")));
  EXPECT_THAT(refusal_of(two_nodes("links: {transport: tcp}\n")),
              HasSubstr("'tcp' is unknown; allowed: unix, shm, udp"));
  EXPECT_THAT(refusal_of(two_nodes("links: {address: localhost}\n")),
              HasSubstr("'localhost' is not an address in numbers"));
  for (const std::string any : {"0.0.0.0", "'::'", "'::0'", "'0:0:0:0:0:0:0:0'", "'::ffff:0.0.0.0'"})
    EXPECT_THAT(refusal_of(two_nodes("links: {address: " + any + "}\n")), HasSubstr("is not one interface")) << any;
  EXPECT_THAT(refusal_of(two_nodes("links: {port: 65500}\n")),
              HasSubstr("'65500' is out of range; allowed: a whole number, 1024 to 65281"));
}

TEST(WrongEntry, FlagThatIsNeitherTrueNorFalse) {
  EXPECT_THAT(refusal_of(two_nodes("realtime: {lock_memory: yes}\n")),
              HasSubstr("'realtime.lock_memory': 'yes' is unknown; allowed: false, true"));
}

TEST(WrongEntry, InvalidCores) {
  EXPECT_THAT(refusal_of(two_nodes("realtime: {cores: 1}\n")),
              HasSubstr("'realtime.cores': '1' is unknown; allowed: auto, or a list of CPU cores"));
  EXPECT_THAT(refusal_of(two_nodes("realtime: {cores: [0, -1]}\n")),
              HasSubstr("'realtime.cores[1]': '-1' is out of range"));
}

TEST(WrongEntry, RingNameMissingOrUnfit) {
  EXPECT_THAT(refusal_of("nodes: [{id: 0}, {id: 1}]\n"),
              StartsWith("ring.yaml:1:1: the file: 'ring' is missing; allowed: a map of ring"));
  EXPECT_THAT(
      refusal_of("ring: a/b\nnodes: [{id: 0}, {id: 1}]\n"),
      AllOf(StartsWith("ring.yaml:1:7: entry 'ring': 'a/b' is not a name"), HasSubstr("allowed: 1 to 32 letters")));
}

TEST(WrongEntry, IdleTooLongForSilence) {
  EXPECT_THAT(refusal_of(two_nodes("timeouts: {idle: 140ms}\n")),
              AllOf(StartsWith("ring.yaml:6:18: entry 'timeouts.idle': idle 140ms is too long for "
                               "silence 250ms"),
                    HasSubstr("at most half of silence")));
  EXPECT_THAT(refusal_of(two_nodes("timeouts: {silence: 15ms}\n")),
              HasSubstr("'timeouts.silence': idle 50ms is too long for silence 15ms"));
}

TEST(WrongEntry, LongOrUnprintableValuesAreShownInOneShortLine) {
  const std::string refusal = refusal_of(two_nodes("timeouts: {send: \"a\\n\\x07" + std::string(500, 'x') + "\"}\n"));
  EXPECT_THAT(refusal, HasSubstr("'a??xxx"));
  EXPECT_THAT(refusal, HasSubstr("xxx...' is not a time"));
  EXPECT_EQ(refusal.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace limb_ring::config
