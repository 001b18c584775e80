#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace limb_ring::test {

/// A fresh folder of rings for each test, removed at its end.
class OwnFolder : public ::testing::Test {
 protected:
  OwnFolder() {
    folder = ::testing::TempDir() + "limb_ring_XXXXXX";
    if (::mkdtemp(folder.data()) == nullptr) folder.clear();
    ::setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
    ::unsetenv("LIMB_RING_RING");
  }
  ~OwnFolder() override {
    std::error_code ignored;
    if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
  }
  void SetUp() override { ASSERT_FALSE(folder.empty()); }

  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = folder + "/" + name;
    std::ofstream(path) << text;
    return path;
  }

  std::string folder;
};

}  // namespace limb_ring::test
