#include <unistd.h>

#include <filesystem>

#include "config/ring_text.h"
#include "support/temporary_folder.h"

namespace limb_ring::config {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class UnreadableFile : public ::testing::Test {
 protected:
  std::string file(const std::string& text) const { return temporary_.write("ring.yaml", text); }
  static std::string refusal_of_file(const std::string& path) {
    try {
      load_ring(path);
      return {};
    } catch (const ConfigError& error) {
      return error.what();
    }
  }

  test::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(UnreadableFile, IsReadIfNothingIsWrong) {
  const std::string path = file(two_nodes());
  EXPECT_EQ(load_ring(path).path, path);
}

TEST_F(UnreadableFile, ThatIsXmlIsCalledXml) {
  for (const char* text : {"<robot name=\"r\"/>", "\xEF\xBB\xBF<?xml version=\"1.0\"?>\n<sdf/>", "\n  <launch/>"})
    EXPECT_THAT(refusal_of_file(file(text)), HasSubstr(": is XML, not YAML; if it describes a robot, 'ringctl new "));
}

TEST_F(UnreadableFile, ThatIsNotThere) {
  EXPECT_EQ(refusal_of_file(folder_ + "/none.yaml"), folder_ + "/none.yaml: there is no such file");
  EXPECT_EQ(refusal_of_file("no/such.yaml"),
            "no/such.yaml: there is no such file (looked in " + std::filesystem::current_path().string() + ")");
}

TEST_F(UnreadableFile, ThatIsAFolderOrADevice) {
  EXPECT_THAT(refusal_of_file(folder_), HasSubstr("is not a file; allowed: a regular file"));
  EXPECT_THAT(refusal_of_file("/dev/zero"), HasSubstr("is not a file"));
}

TEST_F(UnreadableFile, ThatMayNotBeRead) {
  const std::string path = file(two_nodes());
  std::filesystem::permissions(path, std::filesystem::perms::none);
  if (::access(path.c_str(), R_OK) == 0) GTEST_SKIP() << "root may read everything";
  EXPECT_THAT(refusal_of_file(path), HasSubstr("cannot be read: Permission denied"));
}

TEST_F(UnreadableFile, ThatCannotBeReadToItsEnd) {
  // A regular file; reading at address 0 of this process's memory is an error of the device.
  EXPECT_EQ(refusal_of_file("/proc/self/mem"), "/proc/self/mem: cannot be read: Input/output error");
}

TEST_F(UnreadableFile, ThatIsTooLarge) {
  EXPECT_THAT(refusal_of_file(file(std::string((1 << 20) + 1, '#'))), HasSubstr("is too large; allowed: up to 1 MiB"));
}

TEST(NotYaml, IsRefusedWithItsPlace) {
  EXPECT_THAT(refusal_of("ring: pair\nnodes: [{id: 0\n"),
              AllOf(StartsWith("ring.yaml:3:1: is not YAML: "), HasSubstr("end of map")));
  EXPECT_THAT(refusal_of("ring: pair\n\tnodes: 1\n"), StartsWith("ring.yaml:2:"));
  for (const char* tab : {"ring: pair\nnodes:\n\t- {id: 0}\n", "ring: pair\nnodes:\n  - id: 0\n  \tname: a\n",
                          "ring: pair\nlimits:\n\tclients: 3\n"})
    EXPECT_THAT(refusal_of(tab), HasSubstr("; the line is indented by a tab, allowed: blanks")) << tab;
  EXPECT_THAT(refusal_of("ring: pair\nnodes:\n  - {id: 0\tname: *a}\n"), Not(HasSubstr("tab")));
  EXPECT_THAT(refusal_of("ring: *nobody\n"), AllOf(StartsWith("ring.yaml:1:"), HasSubstr("anchor")));
}

TEST(NotYaml, EmptyOrSeveralDocumentsOrNoMap) {
  EXPECT_THAT(refusal_of(""), HasSubstr("holds no YAML document; allowed: one"));
  EXPECT_THAT(refusal_of("ring: r\n---\nring: r\n"), StartsWith("ring.yaml:2:1: what begins here is not part of"));
  EXPECT_THAT(refusal_of("- ring\n"), HasSubstr("the file: a list is not a map"));
  EXPECT_THAT(refusal_of("ring\n"), HasSubstr("the file: 'ring' is not a map"));
}

TEST(NotYaml, ATrailingComma) {
  EXPECT_THAT(refusal_of("{ring: r, nodes: [{id: 0}, {id: 1}]},\n"),
              StartsWith("ring.yaml:1:37: what begins here is not part of the YAML document; allowed: one document"));
  for (const char* left_over :
       {",", ",\n", "a,", "[],", "{},", "],", "}", "{},,", "---\n,", "a: 1\n...\n,", "? ,", "\"a\","})
    EXPECT_THAT(refusal_of(left_over), StartsWith("ring.yaml")) << left_over;
}

TEST(NotYaml, CommentsAndAnEndBehindTheDocumentAreFine) {
  EXPECT_EQ(parse_ring(two_nodes() + "# the end\n...\n# more\n", "ring.yaml").nodes.size(), 2u);
  EXPECT_EQ(parse_ring("---\n" + two_nodes(), "ring.yaml").nodes.size(), 2u);
}

TEST(NotYaml, BracketsWithoutEnd) {
  EXPECT_THAT(refusal_of("ring: " + std::string(100000, '[')),
              AllOf(StartsWith("ring.yaml:1:"), HasSubstr("nested too deep; allowed: 64 levels")));
  EXPECT_THAT(refusal_of("ring: " + std::string(100000, '{')), HasSubstr("nested too deep"));
}

TEST(NotYaml, SixtyFourLevelsAndNoMore) {
  const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  EXPECT_THAT(refusal_of(nested(64)), HasSubstr("a list is not a map"));
  EXPECT_THAT(refusal_of(nested(65)), StartsWith("ring.yaml:1:65: lists and maps are nested too deep"));
}

TEST(NotYaml, ListsWithinListsWithoutEnd) {
  std::string lists, keys;
  for (int i = 0; i < 5000; ++i) lists += "- ", keys += "? ";
  EXPECT_THAT(refusal_of(lists), HasSubstr("nested too deep"));
  EXPECT_THAT(refusal_of(keys), HasSubstr("nested too deep"));
}

TEST(NotYaml, DeepByAliasesOnly) {
  std::string text = "a0: &a0 []\n";
  for (int i = 1; i < 100; ++i) {
    const std::string n = std::to_string(i), before = std::to_string(i - 1);
    text += "a" + n + ": &a" + n + " [*a" + before + "]\n";
  }
  EXPECT_THAT(refusal_of(text), AllOf(StartsWith("ring.yaml:64:"), HasSubstr("nested too deep")));
}

TEST(NotYaml, AnAliasOfItsOwnContainer) {
  EXPECT_THAT(refusal_of("&a\nring: r\nnodes: [*a, *a]\n"),
              AllOf(StartsWith("ring.yaml:3:9: "), HasSubstr("holds itself")));
  EXPECT_THAT(refusal_of("ring: &a [*a]\n"), HasSubstr("holds itself"));
  EXPECT_THAT(refusal_of("ring: &a {*a : 1}\n"), HasSubstr("holds itself"));
}

TEST(NotYaml, AliasesThatStandForTooMuch) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 20; ++i) {
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 10; ++k) text += (k == 0 ? "*a" : ", *a") + std::to_string(i - 1);
    text += "]\n";
  }
  EXPECT_THAT(refusal_of(text), AllOf(StartsWith("ring.yaml:6:"), HasSubstr("too many values")));
}

TEST(NotYaml, AnAliasMayStandForWhatEndedBefore) {
  EXPECT_EQ(parse_ring("ring: r\nnodes: [{id: 0, link: &slow {rate: 1Mbit/s}}, {id: 1, link: *slow}]\n", "ring.yaml")
                .nodes[1]
                .link.rate,
            1000000u);
}

TEST(NotYaml, Garbage) {
  std::string garbage;
  std::uint32_t state = 1;  // a fixed seed: the same garbage every time
  for (int i = 0; i < 20000; ++i) {
    state = state * 1664525 + 1013904223;
    garbage += static_cast<char>(state >> 24);
    if (i % 100 == 99) {
      EXPECT_NE(refusal_of(garbage.substr(garbage.size() - 100)), "");
    }
  }
  EXPECT_NE(refusal_of(garbage), "");
}

}  // namespace
}  // namespace limb_ring::config
