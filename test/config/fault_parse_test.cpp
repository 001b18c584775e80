// Faults are read from text. A text that is not a fault gets an error.
#include "config/line_rig.h"
#include "support/thrown.h"

namespace limb_ring::fault {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::string refusal_of(const std::string& text) {
  try {
    from_words(text, kNodes);
    return {};
  } catch (const ParseError& error) {
    return error.what();
  }
}

TEST(FaultWords, NameALineAndWhatHappensOnIt) {
  const Fault fault = from_words("drop hip -> knee packets=3 once_in=10 for=2s seed=4", kNodes);
  EXPECT_EQ(fault.name, Name::drop);
  EXPECT_THAT(fault.nodes, ElementsAre(0));
  EXPECT_EQ(fault.packets, 3u);
  EXPECT_EQ(fault.once_in, 10u);
  EXPECT_EQ(fault.lasts, 2s);
  EXPECT_EQ(fault.seed, 4u);
}

TEST(FaultWords, NameALineAlsoWithoutCharactersThatAShellInterprets) {
  for (const char* text : {"cut hip:knee", "cut hip -> knee", "cut hip->knee", "cut hip : knee"})
    EXPECT_THAT(from_words(text, kNodes).nodes, ElementsAre(0)) << text;
}

TEST(FaultWords, NameTheSecondLineAgainstRingOrder) {
  const Fault fault = from_words("cut hip:ankle", kNodes);
  EXPECT_THAT(fault.nodes, ElementsAre(0));
  EXPECT_TRUE(fault.second_line);
  EXPECT_FALSE(from_words("cut ankle:hip", kNodes).second_line);
  EXPECT_NO_THROW(check_second_line(fault, true, kNodes));
  EXPECT_THAT(test::thrown<ParseError>([&] { check_second_line(fault, false, kNodes); }),
              AllOf(HasSubstr("'cut hip -> ankle' is on a second line"), HasSubstr("cut hip -> knee")));
}

TEST(FaultWords, NameNodesByNameNumberOrAll) {
  EXPECT_THAT(from_words("kill knee 12", kNodes).nodes, ElementsAre(1, 2));
  EXPECT_THAT(from_words("power_cycle all", kNodes).nodes, ElementsAre(0, 1, 2));
}

TEST(FaultWords, ReadBackAsTheyWereWritten) {
  for (const char* text :
       {"cut hip -> knee after_packets=100 of=ankle", "heal ankle -> hip", "stall ankle -> knee", "kill knee ankle",
        "delay hip -> knee packets=7 delay=2ms jitter=500us after=1s", "hang knee for=1s",
        "rate hip -> knee rate=10Mbit/s", "flap hip -> knee every=40ms for=400ms",
        "drop hip -> knee packets=3 once_in=10 for=2s seed=4", "babble ankle", "suspend knee ankle for=2s",
        "step_clock knee back=3600s", "step_clock knee forward=5ms monotonic=2ms"})
    EXPECT_EQ(to_words(from_words(text, kNodes), kNodes), text);
}

TEST(FaultWords, AreInTheOrderOfTheirNames) {
  for (std::size_t i = 0; i < std::size(kWords); ++i) EXPECT_EQ(kWords[i].name, static_cast<Name>(i));
  EXPECT_EQ(kWords[std::size(kWords) - 1].name, Name::mute);
}

TEST(FaultWords, LastForATimeIfSomethingEndsThemAndAPowerCycleEndsThem) {
  for (const Word& word : kWords) {
    if (word.of == Of::line) continue;
    EXPECT_EQ((word.keys & kFor) != 0, word.ended_by != 0) << word.word;
    EXPECT_EQ(word.to_cpu != ToCpu::nothing, word.of == Of::cpu) << word.word;
    if (word.ended_by != 0) {
      EXPECT_EQ(word.ended_by & kPowerOff, kPowerOff) << word.word;
    }
  }
}

TEST(FaultWords, SayAllNodesOfAHostByItsName) {
  RingNodes nodes = kNodes;
  nodes[1].host = nodes[2].host = "legs";
  EXPECT_THAT(from_words("suspend legs", nodes).nodes, ElementsAre(1, 2));
  EXPECT_EQ(to_words(from_words("suspend legs for=2s", nodes), nodes), "suspend knee ankle for=2s");
  nodes[0].name = "legs";
  EXPECT_THAT(from_words("suspend legs", nodes).nodes, ElementsAre(0)) << "a node goes before a host";
}

TEST(FaultWords, ChangeTheStateOfANodeIfItAllowsThat) {
  EXPECT_EQ(after(Name::kill, Node::runs), Node::dead);
  EXPECT_EQ(after(Name::kill, Node::frozen), Node::dead);
  EXPECT_EQ(after(Name::freeze, Node::runs), Node::frozen);
  EXPECT_EQ(after(Name::suspend, Node::runs), Node::frozen);
  EXPECT_EQ(after(Name::thaw, Node::frozen), Node::runs);
  for (const Node node : {Node::runs, Node::frozen, Node::dead}) EXPECT_EQ(after(Name::step_clock, node), node);
  EXPECT_EQ(after(Name::start, Node::dead), Node::runs);
  EXPECT_EQ(after(Name::power_cycle, Node::runs), Node::runs);
  for (const Name name : {Name::kill, Name::freeze, Name::thaw, Name::power_cycle})
    EXPECT_EQ(after(name, Node::dead), std::nullopt) << word_of(name).word;
  for (const Node node : {Node::runs, Node::frozen}) EXPECT_EQ(after(Name::start, node), std::nullopt);
  EXPECT_EQ(after(Name::power_cycle, Node::frozen), std::nullopt);
}

TEST(FaultWords, NameTheWrongWordAndWhatWouldBeRight) {
  EXPECT_THAT(refusal_of("dorp hip -> knee"),
              StartsWith("'dorp' is not a fault, did you mean 'drop'?; allowed: cut, heal"));
  EXPECT_THAT(refusal_of(""), StartsWith("no fault is named; allowed: cut"));
  EXPECT_THAT(refusal_of("kill nee"),
              StartsWith("'nee' is not a node of the ring, did you mean 'knee'?; allowed: hip"));
  EXPECT_THAT(refusal_of("cut hip -> hip"), AllOf(HasSubstr("is not a line of the ring"), HasSubstr("hip -> knee"),
                                                  HasSubstr("its second line: hip -> ankle")));
  EXPECT_THAT(refusal_of("cut hip"), StartsWith("cut needs a line; allowed: A -> B"));
  EXPECT_THAT(refusal_of("step_clock knee"), StartsWith("step_clock needs forward or back or monotonic"));
  EXPECT_THAT(refusal_of("kill"), StartsWith("kill needs a node; allowed: a node of the ring"));
  EXPECT_THAT(refusal_of("drop hip -> knee packet=3"), HasSubstr("did you mean 'packets'?"));
  EXPECT_THAT(refusal_of("stall hip -> knee packets=3"),
              StartsWith("'packets' is not a parameter of stall; allowed: for, after, after_packets, of"));
  EXPECT_THAT(refusal_of("drop hip -> knee packets=0"),
              StartsWith("'0' is not allowed for 'packets'; allowed: a whole number"));
  EXPECT_THAT(refusal_of("stall hip -> knee for=2"),
              StartsWith("'2' is not allowed for 'for'; allowed: a time such as 5ms"));
  EXPECT_EQ(refusal_of("kill knee 12 knee"), "'knee' is named twice; allowed: each node once");
  EXPECT_EQ(refusal_of("power_cycle knee hip knee"), "'knee' is named twice; allowed: each node once");
  EXPECT_EQ(refusal_of("stall hip -> knee for=2s for=3s"), "'for' is given twice; allowed: once");
  EXPECT_THAT(refusal_of("rate hip -> knee rate=unlimited"), HasSubstr("allowed: a rate such as"));
}

TEST(FaultWords, NameAValueWithoutAKeyAndTheKeyItNeeds) {
  EXPECT_EQ(refusal_of("rate hip:knee 1Mbit/s"), "'1Mbit/s' is a word too many; allowed: rate=1Mbit/s");
  EXPECT_EQ(refusal_of("rate 1Mbit/s hip -> knee"), "'1Mbit/s' is a word too many; allowed: rate=1Mbit/s");
  EXPECT_EQ(refusal_of("rate hip -> nee 1Mbit/s"), "'1Mbit/s' is a word too many; allowed: rate=1Mbit/s");
  EXPECT_EQ(refusal_of("drop hip -> knee 3"), "'3' is a word too many; allowed: packets=3");
  EXPECT_EQ(refusal_of("delay hip : knee 2ms"), "'2ms' is a word too many; allowed: delay=2ms");
  EXPECT_EQ(refusal_of("flap hip->knee 40ms"), "'40ms' is a word too many; allowed: every=40ms");
  EXPECT_EQ(refusal_of("hang knee 1s"), "'1s' is a word too many; allowed: for=1s");
  EXPECT_THAT(refusal_of("stall hip:knee ankle"),
              StartsWith("'ankle' is a word too many; allowed: one line A -> B, and as KEY=VALUE for, after"));
  EXPECT_THAT(refusal_of("heal hip:knee 3"), StartsWith("'3' is a word too many; allowed: one line A -> B"));
}

TEST(FaultWords, ThatAreLongAreShownByTheirBeginning) {
  const std::string word(100000, 'x'), shown = "'" + std::string(60, 'x') + "...'";
  EXPECT_THAT(refusal_of(word), StartsWith(shown + " is not a fault"));
  EXPECT_THAT(refusal_of("kill " + word), StartsWith(shown + " is not a node"));
  EXPECT_THAT(refusal_of("drop hip -> knee " + word + "=1"), StartsWith(shown + " is not a parameter of drop"));
  EXPECT_THAT(refusal_of("drop hip -> knee packets=" + word), StartsWith(shown + " is not allowed"));
  EXPECT_THAT(refusal_of("drop hip -> knee " + word), StartsWith(shown + " is a word too many"));
}

TEST(FaultWords, SayWhatIsMissing) {
  EXPECT_THAT(refusal_of("rate hip -> knee"), StartsWith("rate needs rate; allowed: a rate such as"));
  EXPECT_THAT(refusal_of("delay hip -> knee"), StartsWith("delay needs delay or jitter; allowed: a time"));
  EXPECT_THAT(refusal_of("flap hip -> knee"), StartsWith("flap needs every; allowed: a time"));
  EXPECT_THAT(refusal_of("slow knee"), StartsWith("slow needs every; allowed: a time"));
  EXPECT_THAT(refusal_of("cut hip -> knee after_packets=5"),
              StartsWith("cut needs of; allowed: a node of the ring, whose data packets"));
  EXPECT_THAT(refusal_of("cut hip -> knee of=hip"), StartsWith("cut needs after_packets; allowed: a whole"));
}

}  // namespace
}  // namespace limb_ring::fault
