// In a ring that falls into parts, a node takes each packet once, and leaves none open on a line. (protocol.md sections
// 4.10, 6.3 and 8.11)
#include <random>

#include "core/lone_fold.h"

namespace limb_ring::core {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;
using wire::FoldWordKind;
using wire::SliceKind;

TEST(DuplicateMemory, ThroughAStartOverKeepsAVerdictForAsLongAsACopyMayLast) {
  DuplicateMemory memory(100ms, true);
  const Time decided = Time{} + 1s;
  const wire::Code first = wire::code_of(0);
  memory.meet(3_id, first.incarnation);
  memory.remember(3_id, first, false, DuplicateMemory::Verdict::taken, decided);
  memory.forget_verdicts(decided + 100ms);
  EXPECT_EQ(memory.verdict(3_id, first, false, decided + 100ms), DuplicateMemory::Verdict::doubtful);
  memory.forget_verdicts(decided + 101ms);
  EXPECT_EQ(memory.verdict(3_id, first, false, decided + 100ms), DuplicateMemory::Verdict::none);
}

struct RingInParts : LoneFold {
  std::vector<SliceKind> kinds(Line line) {
    std::vector<SliceKind> all;
    wire::each_slice(node.output(line).view(), [&all](const wire::Slice& slice) { all.push_back(slice.kind); });
    node.output(line).clear();
    return all;
  }
  void receive(Line line, SliceKind kind, const Bytes& bytes) {
    node.receive(line, {kind, {bytes.data(), bytes.size()}}, Time{});
    node.apply(input::Run{}, Time{});
  }
  void lose_first_line() {
    node.apply(input::InputLost{Line::first}, Time{});
    node.apply(input::OutputLost{Line::first}, Time{});
    node.apply(input::Run{}, Time{});
  }
};

// Nobody was behind the break when it turned back: all the others have repeated what it sent. It starts over since.
TEST_F(RingInParts, WhatTheNodeHasSentBackItselfPullsNoPinWhenItComesRound) {
  hear(FoldWordKind::deaf, 5_id);
  receive_interrupt(Line::first, 0, 2);
  ASSERT_EQ(node.counters().pins_pulled, 1u);
  hear(FoldWordKind::hears, 5_id);
  hear(FoldWordKind::begin, 4_id);
  lose_first_line();
  const auto discarded = node.counters().fold_discarded;
  receive_interrupt(Line::second, 0, 3);
  EXPECT_EQ(node.counters().pins_pulled, 1u);
  EXPECT_EQ(node.counters().fold_discarded, discarded + 1);
}

TEST_F(RingInParts, WhatComesBehindTheWordOfAnotherFoldNodeIsTakenAgain) {
  hear(FoldWordKind::begin, 4_id);
  lose_first_line();
  hear(FoldWordKind::begin, 3_id);
  receive_interrupt(Line::second, 0, 2);
  EXPECT_EQ(node.counters().pins_pulled, 1u);
}

TEST_F(RingInParts, AFoldNodeIsForgottenIfTheOwnWordComesRound) {
  hear(FoldWordKind::begin, 6_id);
  node.output(Line::second).clear();
  hear(FoldWordKind::begin, 4_id);
  ASSERT_THAT(kinds(Line::second), ElementsAre(SliceKind::fold)) << "that nothing follows";
  receive_interrupt(Line::second, 0, 5);
  EXPECT_THAT(kinds(Line::second), ElementsAre()) << "nothing is repeated";
}

TEST_F(RingInParts, AnOwnPacketThatHasPassedNoRelayIsNotRepeated) {
  hear(FoldWordKind::begin, 6_id);
  node.output(Line::second).clear();
  test::InterruptPacket packet;
  packet.source = 4_id;
  packet.destination = wire::kBroadcast;
  receive(Line::second, SliceKind::interrupt, encoded(packet));
  EXPECT_THAT(kinds(Line::second), ElementsAre()) << "this node has sent it back, and it has come all the way round";
  packet.hop = 1;
  receive(Line::second, SliceKind::interrupt, encoded(packet));
  EXPECT_THAT(kinds(Line::second), ElementsAre(SliceKind::interrupt)) << "it was sent back at node 5 or beyond";
}

TEST_F(RingInParts, WhatWasTakenShortlyBeforeTheNodeStartedOverPullsNoPinAgain) {
  receive_interrupt(Line::first, 0, 2);
  lose_first_line();
  node.apply(input::InputUp{Line::first, 3_id}, Time{});
  node.apply(input::OutputUp{Line::first, 5_id}, Time{});
  receive_interrupt(Line::first, 0, 2);
  EXPECT_EQ(node.counters().pins_pulled, 1u);
  EXPECT_EQ(node.counters().doubtful_retries, 1u);
  receive_interrupt(Line::first, 1, 2);
  EXPECT_EQ(node.counters().pins_pulled, 2u);
}

// ---- protocol.md section 6.3 ------------------------------------------------------------------------

const Bytes kPacket = Foreign{1, 2}.with(pattern(8));

TEST_F(RingInParts, ADatpOnTheFirstLineIsAbortedThereWhenTheNodeTurnsBack) {
  receive(Line::first, SliceKind::start, head_of(kPacket));
  node.output(Line::first).clear();
  hear(FoldWordKind::deaf, 5_id);
  EXPECT_THAT(kinds(Line::first), Contains(SliceKind::abort));
}

TEST_F(RingInParts, ADatpThatIsSentBackIsAbortedWhenTheInputIsLost) {
  hear(FoldWordKind::deaf, 5_id);
  receive(Line::first, SliceKind::start, head_of(kPacket));
  node.output(Line::second).clear();
  node.apply(input::InputLost{Line::first}, Time{});
  EXPECT_THAT(kinds(Line::second), Contains(SliceKind::abort));
}

TEST_F(RingInParts, ADatpThatTheNodeStopsRepeatingIsAborted) {
  hear(FoldWordKind::begin, 6_id);
  receive(Line::second, SliceKind::start, head_of(kPacket));
  node.output(Line::second).clear();
  hear(FoldWordKind::deaf, 5_id);
  EXPECT_THAT(kinds(Line::second), ElementsAre(SliceKind::abort, SliceKind::fold));
}

TEST_F(RingInParts, TheEndOfADatpIsNotRepeatedOntoALinkThatItDidNotBeginOn) {
  hear(FoldWordKind::begin, 6_id);
  receive(Line::second, SliceKind::start, head_of(kPacket));
  node.apply(input::OutputLost{Line::second}, Time{});
  node.apply(input::OutputUp{Line::second, 3_id}, Time{});
  receive(Line::second, SliceKind::end, tail_of(kPacket));
  EXPECT_THAT(kinds(Line::second), Not(Contains(SliceKind::end)));
}

/// What goes onto one line, from each new link on.
class LineGrammar {
 public:
  void begin_link() { open_ = false; }
  /// @return what is wrong with that slice here; empty: nothing
  std::string see(const wire::Slice& slice, Line line) {
    const auto word = wire::fold_word(slice);
    const bool between =
        word && line == Line::second && (word->kind == FoldWordKind::last || word->kind == FoldWordKind::lost);
    if (between && open_) return "a `last` or `lost` inside a DATP";
    switch (slice.kind) {
      case SliceKind::start:
      case SliceKind::whole:
        if (open_) return "a DATP begins inside another one";
        open_ = slice.kind == SliceKind::start;
        return "";
      case SliceKind::more:
        return open_ ? "" : "a `more` of a DATP that has not begun";
      case SliceKind::end:
      case SliceKind::abort:
        return std::exchange(open_, false) ? "" : "the end of a DATP that has not begun";
      default:
        return "";
    }
  }

 private:
  bool open_ = false;
};

/// A node whose neighbours keep the grammar, while its lines come and go, words are said and lost, and DATPs are cut
/// off.
class DisturbedNode {
 public:
  explicit DisturbedNode(unsigned seed) : draws_(seed), node_(settings(seed), now_) { node_.set_cpu_present(true); }

  void act() {
    const Line line = below(2) == 0 ? Line::first : Line::second;
    switch (below(12)) {
      case 0:
        return change_input(line);
      case 1:
        return change_output(line);
      case 2:
        return say_word(line);
      case 3:
        return send();
      case 4:
        if (input(line).up) node_.apply(input::InputGap{line}, now_);
        return turn();
      default:
        return bring(line);
    }
  }
  std::string wrong;
  unsigned slices = 0;

 private:
  struct Input {
    bool up = false;
    Bytes rest;  ///< of a DATP that has begun, whole words first
  };

  static Settings settings(unsigned seed) {
    Settings s = LoneFold::settings();
    if (seed % 2 == 0) s.byte_time_in = s.byte_time_out = 8ns;
    s.beacon = 100us;
    s.fold_permission = 1us;
    s.break_grace = 20us;
    s.send_timeout_least = 50us;
    s.stall = 20us;
    return s;
  }
  unsigned below(unsigned limit) { return static_cast<unsigned>(draws_() % limit); }
  Input& input(Line line) { return inputs_[static_cast<std::size_t>(line)]; }
  NodeId before(Line line) { return line == Line::first ? 3_id : 5_id; }
  NodeId next(Line line) { return line == Line::first ? 5_id : 3_id; }

  void change_input(Line line) {
    Input& in = input(line);
    in.rest.clear();
    if (std::exchange(in.up, !in.up))
      node_.apply(input::InputLost{line}, now_);
    else
      node_.apply(input::InputUp{line, before(line)}, now_);
    turn();
  }
  void change_output(Line line) {
    bool& up = output_up_[static_cast<std::size_t>(line)];
    grammars_[static_cast<std::size_t>(line)].begin_link();
    if (std::exchange(up, !up))
      node_.apply(input::OutputLost{line}, now_);
    else
      node_.apply(input::OutputUp{line, next(line)}, now_);
    turn();
  }
  void say_word(Line line) {
    if (!input(line).up) return;
    const auto kind = static_cast<FoldWordKind>(1 + below(5));
    const bool of_neighbour = kind == FoldWordKind::deaf || kind == FoldWordKind::hears;
    if (!of_neighbour && !input(line).rest.empty()) abort(line);
    wire::SliceWriter word;
    wire::put(word, {kind, of_neighbour ? 5_id : static_cast<NodeId>(1 + below(7))});
    node_.receive(line, wire::parse_slice(word.view()).slice, now_);
    turn();
  }
  void send() {
    const Bytes data = pattern(1 + below(64));
    node_.apply(input::Send{send_of(1, ++token_, static_cast<NodeId>(1 + below(7)), data)}, now_);
    turn();
  }
  void abort(Line line) {
    input(line).rest.clear();
    node_.receive(line, {SliceKind::abort, {}}, now_);
    turn();
  }
  void bring(Line line) {
    Input& in = input(line);
    if (!in.up) return;
    if (in.rest.empty()) return bring_new(line);
    if (below(10) == 0) return abort(line);
    const bool ends = below(2) == 0 || in.rest.size() < 12;
    const auto until = ends ? in.rest.end() : in.rest.begin() + 4;
    const Bytes part(in.rest.begin(), until);
    in.rest.erase(in.rest.begin(), until);
    put(line, ends ? SliceKind::end : SliceKind::more, part);
  }
  void bring_new(Line line) {
    const auto source = static_cast<std::uint8_t>(1 + below(7)),
               to = static_cast<std::uint8_t>(below(3) == 0 ? 255 : 1 + below(7));
    if (below(4) == 0)
      return put(line, SliceKind::interrupt, foreign_interrupt(source, to, 2, static_cast<std::uint8_t>(below(8))));
    const Bytes packet = Foreign{source, to}
                             .with_sequence(static_cast<std::uint8_t>(below(8)))
                             .with_hop(static_cast<std::uint8_t>(below(5)))
                             .with(pattern(1 + below(64)));
    if (below(3) == 0) return put(line, SliceKind::whole, packet);
    input(line).rest = Bytes(packet.begin() + 4, packet.end());
    put(line, SliceKind::start, Bytes(packet.begin(), packet.begin() + 4));
  }
  void put(Line line, SliceKind kind, const Bytes& bytes) {
    node_.receive(line, {kind, {bytes.data(), bytes.size()}}, now_);
    turn();
  }
  void turn() {
    now_ += 1ns * below(below(20) == 0 ? 200'000 : 600);
    node_.apply(input::Timeout{}, now_);
    node_.apply(input::Run{}, now_);
    Event event;
    while (node_.take_event(now_, event)) {
    }
    ReceivedPacket packet;
    while (node_.take(now_, packet)) {
    }
    for (const Line line : node_.lines()) check(line);
  }
  void check(Line line) {
    const auto at = static_cast<std::size_t>(line);
    wire::each_slice(node_.output(line).view(), [&](const wire::Slice& slice) {
      if (!output_up_[at]) return;
      ++slices;
      const std::string problem = grammars_[at].see(slice, line);
      if (wrong.empty() && !problem.empty())
        wrong = problem + (at == 0 ? ", on the first line" : ", on the second line");
    });
    node_.output(line).clear();
  }

  std::mt19937 draws_;
  Time now_{};
  NetworkController node_;
  std::array<Input, 2> inputs_;
  std::array<bool, 2> output_up_{};
  std::array<LineGrammar, 2> grammars_;
  std::uint32_t token_ = 0;
};

TEST(LineGrammar, IsKeptOnBothLinesHoweverANodeFolds) {
  for (unsigned seed = 1; seed <= 2000 && !testing::Test::HasFailure(); ++seed) {
    DisturbedNode node(seed);
    for (unsigned step = 0; step < 300 && node.wrong.empty(); ++step) node.act();
    EXPECT_EQ(node.wrong, "") << "seed " << seed << ", slice " << node.slices;
  }
}

// ---- a ring over several hosts ------------------------------------------------------------------

/// Node 1's hello has gone round without node 0, whose host was out of reach.
struct PartOfSeveralHosts : testing::Test {
  SoloNode solo{Duration{0}, [](Settings& s) { s.several_hosts = true; }};
  void SetUp() override { solo.join(); }
};

TEST_F(PartOfSeveralHosts, ARetryOfANodeThatWasOutOfReachIsNotTaken) {
  solo.receive(SliceKind::whole, Foreign{0, 1}.with_attempt(1).with(text("x")));
  EXPECT_THAT(solo.packets(), ElementsAre());
  EXPECT_EQ(solo.counters().retries_of_unheard_nodes, 1u);
}

TEST_F(PartOfSeveralHosts, ARetryIsNotTakenWhileTheTriesOfPacketsOfBeforeTheOwnStartMayGoOn) {
  Bytes hello(wire::kHelloSize);
  wire::encode(wire::Hello{50}, hello.data());
  solo.receive(SliceKind::whole, Foreign{0, wire::kBroadcast}.with_pri(kControlPri).with(hello));
  solo.receive(SliceKind::whole, Foreign{0, 1}.with_sequence(3).with_attempt(1).with(text("x")));
  EXPECT_THAT(solo.packets(), ElementsAre());
  EXPECT_EQ(solo.counters().retries_of_unaware_nodes, 1u);
}

}  // namespace
}  // namespace limb_ring::core
