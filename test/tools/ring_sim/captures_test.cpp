// Captures of `ring_sim run`, and what `compare-traces` says of those that are not whole.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "support/own_folder.h"
#include "tools/common/ring_file.h"
#include "tools/ring_sim/command_line.h"
#include "tools/ring_sim/run_ring_sim.h"

namespace limb_ring::ring_sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string bytes_of(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

class CompareTraces : public test::OwnFolder {
 protected:
  std::string captured(const std::string& name, const std::string& payload = "512") {
    const std::string path = folder + "/" + name;
    EXPECT_EQ(ring_sim({"run", "--case", "alone", "--payload", payload, "--capture", path}).code, kDone);
    return path;
  }
  /// A copy of its first bytes.
  std::string cut(const std::string& path, std::size_t missing) {
    const std::string bytes = bytes_of(path);
    return write("cut.pcapng", bytes.substr(0, bytes.size() - missing));
  }
  static void is_told(const CliRun& said) {
    EXPECT_EQ(said.code, kUsage) << said.out;
    EXPECT_THAT(said.errors, HasSubstr("cut.pcapng ends in the middle of a packet: it cannot be compared further"));
  }
};

TEST_F(CompareTraces, ATruncatedCaptureIsNeitherTheSameNorDifferent) {
  const std::string whole = captured("whole.pcapng");
  const std::string part = cut(whole, 6);
  is_told(ring_sim({"compare-traces", whole, part}));
  is_told(ring_sim({"compare-traces", part, whole}));
  is_told(ring_sim({"compare-traces", part, part}));
}

TEST_F(CompareTraces, ADifferenceBeforeTheTruncationIsReported) {
  const CliRun said = ring_sim({"compare-traces", captured("other.pcapng", "8"), cut(captured("whole.pcapng"), 6)});
  EXPECT_EQ(said.code, kBroken) << said.errors;
  EXPECT_THAT(said.out, HasSubstr("then they differ"));
}

TEST_F(CompareTraces, WhatCannotBeReadIsNamedWithTheReason) {
  const std::string whole = captured("whole.pcapng"), none = folder + "/none";
  EXPECT_THAT(ring_sim({"compare-traces", whole, none}).errors,
              AllOf(HasSubstr(none), HasSubstr("cannot be read: No such file")));
  EXPECT_THAT(ring_sim({"compare-traces", folder, whole}).errors, HasSubstr("it is a folder"));
}

using RingSimRun = test::OwnFolder;

TEST_F(RingSimRun, WritesTraceAndCaptureIntoFilesOfTheirOwn) {
  const CliRun said = ring_sim({"run", "--trace", folder + "/x", "--capture", folder + "/x"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("--trace and --capture both name " + folder + "/x; each needs a file of its own"));
}

TEST_F(RingSimRun, ADashIsStandardOutputAndTheFiguresGoToStandardError) {
  const CliRun file = ring_sim({"run", "--trace", folder + "/x", "--capture", folder + "/y"});
  for (const auto& [option, written] : {std::pair{"--trace", "/x"}, {"--capture", "/y"}}) {
    const CliRun said = ring_sim({"run", option, "-"});
    EXPECT_EQ(said.code, kDone);
    EXPECT_EQ(said.out, bytes_of(folder + written)) << option;
    EXPECT_EQ(said.errors, file.out);
  }
  EXPECT_FALSE(std::filesystem::exists("-"));
  EXPECT_EQ(ring_sim({"run", "--trace", "-", "--capture", "-"}).code, kUsage);
}

TEST_F(RingSimRun, ADashIsRefusedIfTheReportGoesToStandardOutput) {
  std::ofstream file;
  EXPECT_THAT(app::open_for_writing(file, "-"), HasSubstr("standard output has the report"));
  EXPECT_FALSE(std::filesystem::exists("-"));
}

}  // namespace
}  // namespace limb_ring::ring_sim
