// ringctl traffic why, on captures of ring_sim's cases.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "study/cases.h"
#include "support/own_folder.h"
#include "tools/ringctl/run_ringctl.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/traffic_why.h"

namespace limb_ring::ringctl {
namespace {

using sim::CaptureAt;
using study::Case;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Trace : public test::OwnFolder {
 protected:
  std::string file(const char* name) const { return folder + "/" + name; }

  std::string captured(Case which, CaptureAt at = CaptureAt::inputs_and_outputs) {
    study::Medium medium;
    medium.nodes = 4;
    std::ofstream out(file("case.pcapng"), std::ios::binary);
    run_case(which, medium, 1, {nullptr, &out, at});
    return file("case.pcapng");
  }

  static std::string bytes_of(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Where its block begins.
  static std::size_t first_packet(const std::string& bytes) {
    return bytes.find(std::string("\x06\0\0\0", 4), bytes.find("node0 -> node1"));
  }

  static CliRun trace(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"traffic", "why"});
    return ringctl(std::move(arguments));
  }
};

TEST_F(Trace, OfTheWorstCaseNamesTheOwnPacketOfEveryNode) {
  const CliRun said = trace({captured(Case::adversarial)});
  EXPECT_EQ(said.code, kDone) << said.errors;
  EXPECT_THAT(said.out, HasSubstr("node0 -> node2  DATP"));
  for (const char* node : {"node1", "node2", "node3"})
    EXPECT_THAT(said.out,
                AllOf(HasSubstr("4.192  behind own DATP"), HasSubstr("of " + std::string(node) + " to node0")));
  EXPECT_THAT(said.errors, HasSubstr("1 of 4 that fit"));
}

TEST(HopWords, SayOnWhichLineMostOfTheTimeWent) {
  capture::PacketTrace packet;
  for (const int began : {0, 10, 900, 910, 920}) {
    capture::Hop hop;
    hop.in.emplace().began = hop.out.emplace().began = std::chrono::nanoseconds(began);
    packet.hops.push_back(hop);
  }
  packet.ended = packet.hops.back().in->began;
  for (const std::size_t hop : {1u, 2u, 3u})
    EXPECT_EQ(hop_words(packet, hop, {}).find("on the line here") != std::string::npos, hop == 2) << hop;
  EXPECT_EQ(packet.on_line(2), std::chrono::nanoseconds(890));
  EXPECT_EQ(packet.on_line(0), std::nullopt);
}

TEST_F(Trace, DrawsAPictureWithABarForEachPacketInTheWay) {
  const CliRun said = trace({captured(Case::adversarial), "--svg", file("way.svg")});
  EXPECT_EQ(said.code, kDone) << said.errors;
  std::ifstream in(file("way.svg"));
  const std::string picture{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(picture, AllOf(HasSubstr("<svg"), HasSubstr("</svg>"), HasSubstr("node0 -&gt; node2")));
  std::size_t grey = 0;
  for (auto at = picture.find("#9a9a9a"); at != std::string::npos; at = picture.find("#9a9a9a", at + 1)) ++grey;
  EXPECT_EQ(grey, 3u);
}

TEST_F(Trace, DoesNotDrawOverTheCapture) {
  const std::string path = captured(Case::adversarial);
  const CliRun said = trace({path, "--svg", path});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("--svg names the capture itself: " + path + " would be lost"));
  EXPECT_EQ(trace({path}).code, kDone) << "it is as it was";
}

TEST_F(Trace, WithOverShowsAllThatWereSlower) {
  EXPECT_THAT(trace({captured(Case::adversarial), "--over", "1us"}).errors, Not(HasSubstr("that fit")));
}

TEST_F(Trace, OfAPacketThatWasNotSeenIsAnError) {
  for (const std::vector<std::string>& choice : {std::vector<std::string>{"--over", "1s"}, {"--at", "1s"}}) {
    std::vector<std::string> arguments{captured(Case::alone)};
    arguments.insert(arguments.end(), choice.begin(), choice.end());
    const CliRun said = trace(arguments);
    EXPECT_EQ(said.code, kNotDone);
    EXPECT_THAT(said.errors, HasSubstr("no such packet among 1 that were seen"));
  }
}

TEST_F(Trace, RefusesACaptureWithoutOutputsAndSaysHowToTakeOne) {
  const CliRun said = trace({captured(Case::alone, CaptureAt::inputs)});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, AllOf(HasSubstr("case.pcapng"), HasSubstr("--at in,out"), HasSubstr("--outputs")));
}

TEST_F(Trace, RefusesWrongTimesAndNodesWithWhatIsRight) {
  const std::string path = captured(Case::alone);
  EXPECT_THAT(trace({path, "--source", "knee"}).errors, AllOf(HasSubstr("'knee'"), HasSubstr("0 (node0)")));
  for (const char* option : {"--over", "--at"}) {
    for (const char* time : {"soon", "1.2.3", "5 weeks"}) {
      const CliRun said = trace({path, option, time});
      EXPECT_EQ(said.code, kUsage) << option << " " << time;
      EXPECT_THAT(said.errors, HasSubstr(std::string(option) + " " + time + ": not a time"));
    }
  }
}

TEST_F(Trace, RefusesAnInvalidInstant) {
  const std::string path = captured(Case::alone);
  for (const char* time : {"-0.5", "-1", "-5ms", "0.+5", "1k.5", "0.1e1"}) {
    const CliRun said = trace({path, "--at", time});
    EXPECT_EQ(said.code, kUsage) << time;
    EXPECT_THAT(said.errors, HasSubstr(std::string("--at ") + time + ": not a time")) << time;
  }
}

TEST_F(Trace, WithJsonPrintsOneLinePerPacket) {
  const CliRun said = trace({captured(Case::adversarial), "--json", "-n", "0"});
  EXPECT_EQ(std::count(said.out.begin(), said.out.end(), '\n'), 4);
  EXPECT_THAT(said.out, HasSubstr(R"("waited_ns":4192)"));
}

TEST_F(Trace, OfACaptureWhoseTimesDoNotFitIsRefused) {
  const std::string path = captured(Case::alone);
  std::string bytes = bytes_of(path);
  const std::size_t packet = first_packet(bytes);
  for (std::size_t i = packet + 12; i < packet + 20; ++i) bytes[i] = '\xFF';
  std::ofstream(path, std::ios::binary) << bytes;
  const CliRun said = trace({path});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("a time after the year 2261"));
}

/// All that read a capture: what they say of it, none of them with a ring.
std::vector<std::string> what_readers_say(const std::string& path) {
  return {ringctl({"traffic", "why", path}).errors, ringctl({"traffic", "show", "-r", path}).errors,
          ringctl({"traffic", "again", path}).errors};
}

TEST_F(Trace, EveryReaderReportsATruncatedCapture) {
  const std::string path = captured(Case::adversarial);
  const std::string whole = bytes_of(path);
  std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - 6);
  for (const std::string& said : what_readers_say(path))
    EXPECT_THAT(said, HasSubstr("case.pcapng ends in the middle of a packet"));
}

TEST_F(Trace, WhatCannotBeReadIsNamedWithTheReason) {
  for (const std::string& said : what_readers_say(folder)) EXPECT_THAT(said, HasSubstr("it is a folder"));
  for (const std::string& said : what_readers_say(file("none"))) EXPECT_THAT(said, HasSubstr("No such file"));
}

TEST_F(Trace, EveryReaderReportsAChangedPacketInACapture) {
  const std::string path = captured(Case::adversarial);
  std::string bytes = bytes_of(path);
  bytes[first_packet(bytes) + 28 + 12 + 7] ^= 1;  // behind the heads of the block and of the packet: its data
  std::ofstream(path, std::ios::binary) << bytes;
  for (const std::string& said : what_readers_say(path))
    EXPECT_THAT(said, HasSubstr("case.pcapng: 1 packet is not as it was captured"));
}

TEST_F(Trace, APictureThatCannotBeWrittenIsNamedBeforeTheRingIsLookedAt) {
  for (const std::string& what : {captured(Case::adversarial), std::string("--live")}) {
    const CliRun said = trace({what, "--svg", file("none/way.svg")});
    EXPECT_EQ(said.code, kUsage) << what;
    EXPECT_THAT(said.errors, HasSubstr("none/way.svg: cannot be written: No such file or directory")) << what;
  }
}

TEST_F(Trace, AFullDiskIsNamedWithItsFile) {
  const std::string path = captured(Case::adversarial);
  const CliRun drawn = trace({path, "--svg", "/dev/full"});
  EXPECT_EQ(drawn.code, kNotDone);
  EXPECT_THAT(drawn.errors, HasSubstr("/dev/full: not all could be written: No space left on device"));
  EXPECT_THAT(drawn.out, HasSubstr("node0 -> node2  DATP")) << "what was found is printed all the same";
  const CliRun copied = ringctl({"traffic", "show", "-r", path, "-w", "/dev/full"});
  EXPECT_EQ(copied.code, kNotDone);
  EXPECT_THAT(copied.errors, HasSubstr("/dev/full: not all could be written: No space left on device"));
}

}  // namespace
}  // namespace limb_ring::ringctl
