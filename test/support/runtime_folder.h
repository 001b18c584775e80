#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace limb_ring::test {

/// A fresh XDG_RUNTIME_DIR for this test alone, so that tests can run side by side.
class RuntimeFolder {
 public:
  RuntimeFolder() {
    if (mkdtemp(path_) == nullptr) throw std::runtime_error("mkdtemp failed");
    setenv("XDG_RUNTIME_DIR", path_, 1);
    unsetenv("LIMB_RING_RING");
    unsetenv("LIMB_RING_NODE");
  }
  ~RuntimeFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  RuntimeFolder(const RuntimeFolder&) = delete;
  RuntimeFolder& operator=(const RuntimeFolder&) = delete;

  std::string path() const { return path_; }

 private:
  char path_[32] = "/tmp/limb_ring_test_XXXXXX";
};

}  // namespace limb_ring::test
