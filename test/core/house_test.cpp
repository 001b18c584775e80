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

/// "core" of "core/time.h", "app/ringctl" of "app/ringctl/screen.h"; empty for a header of the same folder.
std::string part_of(const std::string& name) {
  const auto slash = name.find('/');
  if (slash == std::string::npos) return "";
  const std::string part = name.substr(0, slash);
  return part == "app" ? name.substr(0, name.find('/', slash + 1)) : part;
}

std::vector<std::string> beyond(const fs::path& folder, const std::set<std::string>& parts) {
  std::vector<std::string> wrong;
  for (const Include& i : includes_below(folder))
    if (i.own && parts.count(part_of(i.name)) == 0) wrong.push_back(i.file + " includes " + i.name);
  return wrong;
}

std::vector<std::string> not_standard(const fs::path& folder) {
  std::vector<std::string> wrong;
  for (const Include& i : includes_below(folder)) {
    const bool crc = i.name == "isa-l/crc.h" && i.file == "daemon/wire/checksum.cpp";
    if (!i.own && !standard(i.name) && !crc) wrong.push_back(i.file + " includes <" + i.name + ">");
  }
  return wrong;
}

TEST(House, TheTestReadsTheSources) {
  EXPECT_GT(includes_below(kSource / "daemon" / "core").size(), 50u);
  EXPECT_THAT(beyond(kSource / "daemon" / "core", {"core"}), testing::Not(IsEmpty()));
}

TEST(House, WireCoreAndSimUseTheStandardLibraryAlone) {
  for (const char* part : {"wire", "capture", "core", "fault", "sim", "watchdog"})
    EXPECT_THAT(not_standard(kSource / "daemon" / part), IsEmpty());
}

TEST(House, PublicHeadersKnowEachOtherAndTheStandardLibraryAlone) {
  EXPECT_THAT(beyond(kSource / "include", {"limb_ring"}), IsEmpty());
  EXPECT_THAT(not_standard(kSource / "include"), IsEmpty());
}

TEST(House, FaultsAreReadAndWrittenInOneFileAndElseKnowWireAndTimeAlone) {
  std::vector<std::string> wrong;
  for (const Include& i : includes_below(kSource / "daemon" / "fault")) {
    const bool may = i.name == "core/time.h" || part_of(i.name) == "wire" || part_of(i.name) == "fault";
    if (i.own && !may && i.file != "daemon/fault/parse.cpp") wrong.push_back(i.file + " includes " + i.name);
  }
  EXPECT_THAT(wrong, IsEmpty());
}

TEST(House, CoreHasNoThreadsClocksOrStreams) {
  const std::set<std::string> forbidden{"thread", "mutex", "future", "condition_variable", "iostream", "fstream",
                                        "cstdio", "ctime", "random"};
  std::vector<std::string> wrong;
  for (const char* part : {"wire", "core"})
    for (const Include& i : includes_below(kSource / "daemon" / part))
      if (forbidden.count(i.name) != 0) wrong.push_back(i.file + " includes <" + i.name + ">");
  EXPECT_THAT(wrong, IsEmpty());
}

/// What each folder of daemon/ may include, its own headers aside. limb_ring: the public headers.
using Parts = std::set<std::string>;
const std::map<std::string, Parts> kMayInclude{
    {"wire", {}},
    {"capture", {"wire", "limb_ring"}},
    {"core", {"wire"}},
    {"promises", {"wire", "core", "capture", "process"}},
    {"recorder", {"wire", "core", "capture", "promises", "process"}},
    {"fault", {"wire", "core", "config"}},
    {"statistics", {"core"}},
    {"sim", {"wire", "core", "promises"}},
    {"watchdog", {"wire", "core", "config"}},
    {"setup", {"wire", "core", "config", "link", "limb_ring"}},
    {"sim_tools", {"wire", "capture", "core", "fault", "sim", "setup", "config"}},
    {"scenario", {"wire", "capture", "core", "fault", "sim", "sim_tools", "setup", "config", "watchdog"}},
    {"study",
     {"wire", "core", "fault", "statistics", "sim", "sim_tools", "scenario", "setup", "config", "payload", "process",
      "limb_ring"}},
    {"config", {"wire", "process", "limb_ring"}},
    {"cli", {"config"}},
    {"payload", {"wire", "limb_ring"}},
    {"client", {"wire", "capture", "process", "limb_ring"}},
    {"event_loop", {"wire", "process"}},
    {"link", {"wire", "event_loop", "process"}},
    {"host", {"wire", "capture", "client", "event_loop", "process", "limb_ring"}},
    {"firmware", {"wire", "payload", "config", "cli", "client", "process", "limb_ring"}},
    {"process", {}},
    {"runtime",
     {"wire", "capture", "core", "fault", "link", "config", "setup", "host", "client", "payload", "statistics",
      "watchdog", "promises", "recorder", "process", "event_loop", "limb_ring"}},
    {"virtual_host",
     {"wire", "core", "fault", "link", "config", "setup", "host", "client", "live", "process", "runtime", "sim",
      "sim_tools", "event_loop", "limb_ring"}},
    {"program_stage", {"wire", "core", "fault", "config", "process", "runtime", "scenario", "sim", "virtual_host"}},
    {"live", {"fault", "wire", "config", "process", "promises", "limb_ring"}},
    {"ask", {"wire", "live", "payload", "process", "limb_ring"}},
    {"bench", {"wire", "capture", "core", "promises", "config", "live", "process", "statistics", "limb_ring"}},
    {"app/common", {"config", "process"}},
    {"app/capture_text", {"app/common", "wire", "capture", "limb_ring"}},
    {"app/ringd",
     {"app/common", "cli", "config", "core", "event_loop", "process", "runtime", "setup", "sim", "sim_tools",
      "virtual_host"}},
    {"app/ringctl",
     {"app/common",
      "app/capture_text",
      "app/scenario_cpu",
      "wire",
      "capture",
      "core",
      "fault",
      "config",
      "cli",
      "payload",
      "ask",
      "live",
      "process",
      "program_stage",
      "scenario",
      "sim",
      "client",
      "statistics",
      "bench",
      "promises",
      "recorder",
      "limb_ring"}},
    {"app/ring_sim",
     {"app/common", "app/capture_text", "wire", "capture", "core", "sim", "sim_tools", "scenario", "study", "config",
      "cli", "process", "promises"}},
    {"app/scenario_cpu", {"limb_ring"}},
    {"app/run_scenario", {"app/ringctl", "process"}},
};

TEST(House, ArrowsPointOneWay) {
  for (const auto& [part, parts] : kMayInclude) {
    Parts may = parts;
    may.insert(part);
    EXPECT_THAT(beyond(kSource / "daemon" / part, may), IsEmpty()) << part;
  }
}

/// Folders of daemon/ of which a file names something, as `core::Time`. Comments do not count.
std::set<std::string> parts_named_in(const fs::path& path) {
  std::set<std::string> named;
  std::ifstream file(path);
  for (std::string text; std::getline(file, text);) {
    text = ' ' + text.substr(0, text.find("//"));
    for (const auto& [part, may] : kMayInclude) {
      const auto at = text.find(part + "::");
      if (at != std::string::npos && std::isalnum(text[at - 1]) == 0 && text[at - 1] != '_') named.insert(part);
    }
  }
  return named;
}

TEST(House, WhatAFolderNamesItMayInclude) {
  std::vector<std::string> wrong;
  for (const auto& [part, may] : kMayInclude)
    for (const auto& entry : fs::recursive_directory_iterator(kSource / "daemon" / part))
      for (const std::string& named : parts_named_in(entry.path())) {
        const bool of_public_header = named == "payload" && may.count("limb_ring") != 0;
        if (named != part && may.count(named) == 0 && !of_public_header)
          wrong.push_back(entry.path().lexically_relative(kSource).string() + " names " + named + "::");
      }
  EXPECT_THAT(wrong, IsEmpty());
}

TEST(House, EveryFolderHasItsArrows) {
  for (const char* folder : {"daemon", "daemon/app"})
    for (const auto& entry : fs::directory_iterator(kSource / folder)) {
      const std::string part = entry.path().lexically_relative(kSource / "daemon");
      if (!entry.is_directory() || part == "app") continue;
      EXPECT_EQ(kMayInclude.count(part), 1u) << part;
    }
}

TEST(House, EveryFolderHasItsTests) {
  for (const auto& entry : fs::directory_iterator(kSource / "daemon"))
    EXPECT_TRUE(!entry.is_directory() || fs::exists(kSource / "test" / entry.path().filename())) << entry.path();
}

TEST(House, EveryFolderIsInContributing) {
  std::ifstream file(kSource / "CONTRIBUTING.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const auto& entry : fs::directory_iterator(kSource / "daemon")) {
    if (!entry.is_directory()) continue;
    EXPECT_THAT(text, testing::HasSubstr("\n  " + entry.path().filename().string() + "/ ")) << entry.path();
  }
}

TEST(House, MicroBenchmarksDriveCoreRecorderAndSimulationAlone) {
  EXPECT_THAT(beyond(kSource / "bench", {"wire", "core", "recorder", "sim", "cli", "app/common", "support", ""}),
              IsEmpty());
}

TEST(House, TheBridgeKnowsNothingOfTheDaemonsInside) {
  std::vector<std::string> wrong;
  for (const Include& i : includes_below(kSource / "ros_bridge"))
    for (const char* inside : {"core/", "link/", "host/", "runtime/", "sim/"})
      if (i.name.rfind(inside, 0) == 0) wrong.push_back(i.file + " includes " + i.name);
  EXPECT_THAT(wrong, IsEmpty());
}

}  // namespace
