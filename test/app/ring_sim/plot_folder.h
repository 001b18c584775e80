#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "app/ring_sim/plots/gnuplot.h"
#include "support/thrown.h"

namespace limb_ring::ring_sim {

/// A fresh folder for each test, removed at its end; PATH is put back too.
class PlotTest : public ::testing::Test {
 protected:
  PlotTest() {
    folder = ::testing::TempDir() + "ring_sim_XXXXXX";
    if (::mkdtemp(folder.data()) == nullptr) folder.clear();
    if (const char* path = ::getenv("PATH")) path_ = path;
  }
  ~PlotTest() override {
    std::error_code ignored;
    if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
    ::setenv("PATH", path_.c_str(), 1);
  }
  void SetUp() override { ASSERT_FALSE(folder.empty()); }

  static bool gnuplot_missing() {
    return !test::thrown<std::runtime_error>([] { find_gnuplot(); }).empty();
  }

  static std::string read(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  std::string folder;

 private:
  std::string path_;
};

/// At the start of a test that draws.
#define LIMB_RING_NEEDS_GNUPLOT() \
  if (gnuplot_missing()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)"

}  // namespace limb_ring::ring_sim
