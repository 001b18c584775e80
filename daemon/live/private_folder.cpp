#include "live/private_folder.h"

#include <stdlib.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace limb_ring::live {

PrivateFolder::PrivateFolder() {
  path_ = (std::filesystem::temp_directory_path() / "limb_ring_bench_XXXXXX").string();
  if (::mkdtemp(path_.data()) == nullptr)
    throw std::system_error(errno, std::generic_category(), "cannot make a folder " + path_);
  replace("XDG_RUNTIME_DIR", path_.c_str());
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
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
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
