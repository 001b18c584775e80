#pragma once

#include <stdlib.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "comparison/plots/plots.h"
#include "support/own_folder.h"
#include "support/thrown.h"

namespace limb_ring::comparison {

/// A fresh folder for each test, removed at its end; PATH is put back too.
class PlotTest : public test::OwnFolder {
 protected:
  PlotTest() {
    if (const char* path = ::getenv("PATH")) path_ = path;
  }
  ~PlotTest() override { ::setenv("PATH", path_.c_str(), 1); }

  static bool gnuplot_missing() {
    return !test::thrown<std::runtime_error>([] { find_gnuplot(); }).empty();
  }

  static std::string read(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

 private:
  std::string path_;
};

/// At the start of a test that draws.
#define LIMB_RING_NEEDS_GNUPLOT() \
  if (gnuplot_missing()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)"

}  // namespace limb_ring::comparison
