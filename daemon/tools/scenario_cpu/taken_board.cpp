#include "tools/scenario_cpu/taken_board.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "limb_ring/ring_directory.h"

namespace limb_ring::scenario_cpu {

namespace {

constexpr std::size_t kSize = 256 * sizeof(std::uint64_t);  // one for each value of a byte

[[noreturn]] void refuse(const std::string& path) {
  throw std::system_error(errno, std::generic_category(), "cannot use " + path);
}

}  // namespace

TakenBoard::TakenBoard(const std::string& ring, std::uint8_t node) {
  const std::string file = make_ring_directory(ring) + "/" + std::to_string(node) + ".taken";
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0) refuse(file);
  void* memory =
      ::ftruncate(fd, kSize) == 0 ? ::mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0) : MAP_FAILED;
  const int error = errno;
  ::close(fd);
  errno = error;
  if (memory == MAP_FAILED) refuse(file);
  counts_ = static_cast<Count*>(memory);
}

TakenBoard::~TakenBoard() { ::munmap(counts_, kSize); }

}  // namespace limb_ring::scenario_cpu
