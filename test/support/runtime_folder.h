#pragma once

#include <stdlib.h>

#include "support/temporary_folder.h"

namespace limb_ring::test {

/// A fresh XDG_RUNTIME_DIR for this test alone, so that tests can run side by side.
class RuntimeFolder : public TemporaryFolder {
 public:
  RuntimeFolder() {
    ::setenv("XDG_RUNTIME_DIR", path().c_str(), 1);
    ::unsetenv("LIMB_RING_RING");
    ::unsetenv("LIMB_RING_NODE");
  }
};

}  // namespace limb_ring::test
