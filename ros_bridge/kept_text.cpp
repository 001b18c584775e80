#include "ros_bridge/kept_text.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace limb_ring::bridge {

KeptText::KeptText() : file_(::memfd_create("limb_ring kept text", MFD_CLOEXEC)) {}

// Half a text would be worse than none.
void KeptText::put(const std::string& text) const {
  if (::ftruncate(file_.get(), 0) != 0) return;
  if (::pwrite(file_.get(), text.data(), text.size(), 0) == static_cast<ssize_t>(text.size())) return;
  (void)!::ftruncate(file_.get(), 0);
}

std::string KeptText::get() const {
  struct stat status {};
  if (::fstat(file_.get(), &status) != 0) return {};
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  const ssize_t size = ::pread(file_.get(), text.data(), text.size(), 0);
  text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return text;
}

}  // namespace limb_ring::bridge
