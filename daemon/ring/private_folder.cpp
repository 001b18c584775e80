#include "ring/private_folder.h"

#include <stdlib.h>

namespace limb_ring::live {

PrivateFolder::PrivateFolder() {
  replace("XDG_RUNTIME_DIR", path().c_str());
  replace("LIMB_RING_RING", nullptr);
  replace("LIMB_RING_NODE", nullptr);
}

PrivateFolder::~PrivateFolder() {
  for (const auto& [name, value] : before_) {
    if (value)
      ::setenv(name.c_str(), value->c_str(), 1);
    else
      ::unsetenv(name.c_str());
  }
}

void PrivateFolder::replace(const std::string& name, const char* value) {
  const char* old = ::getenv(name.c_str());
  before_[name] = old == nullptr ? std::nullopt : std::optional<std::string>(old);
  if (value != nullptr)
    ::setenv(name.c_str(), value, 1);
  else
    ::unsetenv(name.c_str());
}

}  // namespace limb_ring::live
