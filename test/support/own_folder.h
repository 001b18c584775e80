#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/runtime_folder.h"

namespace limb_ring::test {

/// A test with a fresh folder, in which rings are looked for, too.
class OwnFolder : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const { return runtime_.write(name, text); }

 private:
  RuntimeFolder runtime_;

 protected:
  const std::string folder = runtime_.path();
};

}  // namespace limb_ring::test
