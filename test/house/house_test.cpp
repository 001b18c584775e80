// The arrows of the house, read from the #include lines: wire and core know no IO, nothing points
// upwards, ROS never sees the core.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

const fs::path kSource = LIMB_RING_SOURCE;

struct Include {
  std::string file, name;
  bool own;  ///< in quotes
};

void read_includes(const fs::path& path, std::vector<Include>& out) {
  std::ifstream file(path);
  for (std::string text; std::getline(file, text);) {
    const auto start = text.find_first_of("<\"");
    if (text.rfind("#include", 0) != 0 || start == std::string::npos) continue;
    const auto end = text.find_first_of(">\"", start + 1);
    out.push_back({path.lexically_relative(kSource), text.substr(start + 1, end - start - 1), text[start] == '"'});
  }
}

std::vector<Include> includes_below(const fs::path& folder) {
  std::vector<Include> out;
  if (!fs::exists(folder)) return out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    if (extension == ".h" || extension == ".cpp") read_includes(entry.path(), out);
  }
  return out;
}

/// Headers of the C++ standard library have neither a folder nor an extension.
bool standard(const std::string& name) { return name.find_first_of("./") == std::string::npos; }

/// "core" of "core/time.h"; empty for a header of the same folder.
std::string part_of(const std::string& name) {
  const auto slash = name.find('/');
  return slash == std::string::npos ? "" : name.substr(0, slash);
}

std::vector<std::string> beyond(const fs::path& folder, const std::set<std::string>& parts) {
  std::vector<std::string> wrong;
  for (const Include& i : includes_below(folder))
    if (i.own && parts.count(part_of(i.name)) == 0) wrong.push_back(i.file + " includes " + i.name);
  return wrong;
}

/// Headers that are no part of the standard library, and where they may be.
const std::map<std::string, std::string> kOthers{{"isa-l/crc.h", "daemon/wire/checksum.cpp"},
                                                 {"yaml-cpp/yaml.h", "daemon/sim/scenario_shrink.cpp"}};

std::vector<std::string> not_standard(const fs::path& folder) {
  std::vector<std::string> wrong;
  for (const Include& i : includes_below(folder)) {
    const auto other = kOthers.find(i.name);
    const bool may = standard(i.name) || (other != kOthers.end() && other->second == i.file);
    if (!i.own && !may) wrong.push_back(i.file + " includes <" + i.name + ">");
  }
  return wrong;
}

TEST(House, TheTestReadsTheSources) {
  EXPECT_GT(includes_below(kSource / "daemon" / "core").size(), 50u);
  EXPECT_THAT(beyond(kSource / "daemon" / "core", {"core"}), testing::Not(IsEmpty()));
}

TEST(House, WireCoreAndSimUseTheStandardLibraryAlone) {
  for (const char* room : {"wire", "core", "sim"}) EXPECT_THAT(not_standard(kSource / "daemon" / room), IsEmpty());
}

TEST(House, PublicHeadersKnowEachOtherAndTheStandardLibraryAlone) {
  EXPECT_THAT(beyond(kSource / "include", {"limb_ring"}), IsEmpty());
  EXPECT_THAT(not_standard(kSource / "include"), IsEmpty());
}

TEST(House, WhatFaultsAreAndDoKnowsWireAndTimeAlone) {
  std::vector<std::string> wrong;
  for (const char* file : {"fault.h", "fault.cpp", "line_faults.h", "line_faults.cpp"}) {
    std::vector<Include> includes;
    read_includes(kSource / "daemon" / "config" / file, includes);
    EXPECT_THAT(includes, testing::Not(IsEmpty())) << file;
    for (const Include& i : includes) {
      const bool may = i.name == "core/time.h" || part_of(i.name) == "wire" || i.name == "config/fault.h" ||
                       i.name == "config/fault.h" || i.name.find("line_") != std::string::npos ||
                       i.name == "config/line_faults.h";
      if (i.own && !may) wrong.push_back(i.file + " includes " + i.name);
    }
  }
  EXPECT_THAT(wrong, IsEmpty());
}

TEST(House, CoreHasNoThreadsClocksOrStreams) {
  const std::set<std::string> forbidden{"thread", "mutex", "future", "condition_variable", "iostream", "fstream",
                                        "cstdio", "ctime", "random"};
  std::vector<std::string> wrong;
  for (const char* part : {"wire", "core"})
    for (const Include& i : includes_below(kSource / "daemon" / part))
      if (forbidden.count(i.name) != 0 && i.file != "daemon/wire/pcapng.h")
        wrong.push_back(i.file + " includes <" + i.name + ">");
  EXPECT_THAT(wrong, IsEmpty());
}

/// What each room of daemon/ may include, its own headers aside. limb_ring: the public headers. docs/rooms.svg shows
/// it.
using Rooms = std::set<std::string>;
const std::map<std::string, Rooms> kMayInclude{
    {"wire", {"limb_ring"}},
    {"core", {"wire"}},
    {"config", {"wire", "core", "limb_ring"}},
    {"io", {"wire"}},
    {"client", {"wire", "io", "limb_ring"}},
    {"judge", {"wire", "core", "io"}},
    {"sim", {"wire", "core", "config", "judge"}},
    {"node", {"wire", "core", "config", "io", "client", "judge", "sim", "limb_ring"}},
    {"ring", {"wire", "config", "io", "judge", "limb_ring"}},
    {"study", {"wire", "core", "config", "io", "judge", "sim", "limb_ring"}},
    {"tools",
     {"wire", "core", "config", "io", "client", "judge", "sim", "node", "ring", "study", "bench", "comparison",
      "limb_ring"}},
};

TEST(House, ArrowsPointOneWay) {
  for (const auto& [room, rooms] : kMayInclude) {
    Rooms may = rooms;
    may.insert(room);
    EXPECT_THAT(beyond(kSource / "daemon" / room, may), IsEmpty()) << room;
  }
}

/// Calls visit(file, line) for each line of the sources of a room, without its comments.
template <class Visit>
void each_line(const std::string& room, Visit visit) {
  for (const auto& entry : fs::recursive_directory_iterator(kSource / "daemon" / room)) {
    std::ifstream file(entry.path());
    for (std::string text; std::getline(file, text);)
      visit(entry.path().lexically_relative(kSource).string(), ' ' + text.substr(0, text.find("//")));
  }
}

/// The rooms that put something into a namespace, by its name: core, of limb_ring::core.
std::map<std::string, Rooms> namespaces() {
  const std::string opens = " namespace limb_ring::";
  std::map<std::string, Rooms> found;
  for (const auto& [room, may] : kMayInclude)
    each_line(room, [&, in = room](const std::string&, const std::string& line) {
      if (line.rfind(opens, 0) == 0)
        found[line.substr(opens.size(), line.find(' ', opens.size()) - opens.size())].insert(in);
    });
  return found;
}

bool names(const std::string& line, const std::string& space) {
  const auto at = line.find(space + "::");
  return at != std::string::npos && std::isalnum(line[at - 1]) == 0 && line[at - 1] != '_';
}

TEST(House, WhatARoomNamesItMayInclude) {
  std::vector<std::string> wrong;
  const auto spaces = namespaces();
  EXPECT_EQ(spaces.at("core"), Rooms{"core"});
  for (const auto& [room, may] : kMayInclude)
    each_line(room, [&, in = room, seen = may](const std::string& file, const std::string& line) {
      for (const auto& [space, rooms] : spaces) {
        const bool of_public_header = space == "payload" && seen.count("limb_ring") != 0;
        bool may_name = rooms.count(in) != 0 || of_public_header;
        for (const std::string& of : rooms) may_name = may_name || seen.count(of) != 0;
        if (!may_name && names(line, space)) wrong.push_back(file + " names " + space + "::");
      }
    });
  EXPECT_THAT(wrong, IsEmpty());
}

TEST(House, EveryFolderOfTheDaemonIsARoomAndThereAreAtMostEleven) {
  std::size_t rooms = 0;
  for (const auto& entry : fs::directory_iterator(kSource / "daemon")) {
    if (!entry.is_directory() || includes_below(entry.path()).empty()) continue;
    ++rooms;
    EXPECT_EQ(kMayInclude.count(entry.path().filename()), 1u) << entry.path();
  }
  EXPECT_LE(rooms, 11u);
}

TEST(House, EveryRoomHasItsTests) {
  Rooms tested;
  for (const Include& i : includes_below(kSource / "test")) tested.insert(part_of(i.name));
  for (const auto& [room, may] : kMayInclude) EXPECT_EQ(tested.count(room), 1u) << room;
}

TEST(House, BenchmarksKnowNoStudyAndNoBridge) {
  EXPECT_THAT(beyond(kSource / "bench", {"wire", "core", "config", "io", "judge", "sim", "node", "ring", "tools",
                                         "bench", "limb_ring", "support", ""}),
              IsEmpty());
}

TEST(House, TheBridgeKnowsNothingOfTheDaemonsInside) {
  std::vector<std::string> wrong;
  for (const Include& i : includes_below(kSource / "ros_bridge"))
    for (const char* inside : {"core/", "node/", "sim/", "study/"})
      if (i.name.rfind(inside, 0) == 0) wrong.push_back(i.file + " includes " + i.name);
  EXPECT_THAT(wrong, IsEmpty());
}

}  // namespace
