#include "tools/scenario_cpu/taken_board.h"

#include <fcntl.h>
#include <sys/mman.h>

#include <stdexcept>

#include "io/regular_file.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::scenario_cpu {

namespace {

constexpr std::size_t kSize = 256 * sizeof(std::uint64_t);  // one for each value of a byte

/// A file that is there has the counts of the CPU's former processes.
process::MappedFile map_board(const std::string& path) {
  const process::UniqueFd file = process::open_regular(path, O_RDWR | O_CREAT);
  if (!file.valid()) throw std::runtime_error("cannot use " + path + ": " + process::why_not_opened(path));
  process::allocate(file, kSize, path);
  return process::MappedFile(file, kSize, PROT_READ | PROT_WRITE, path);
}

}  // namespace

TakenBoard::TakenBoard(const std::string& ring, std::uint8_t node)
    : file_(map_board(make_ring_directory(ring) + "/" + std::to_string(node) + ".taken")),
      counts_(static_cast<Count*>(file_.data())) {}

}  // namespace limb_ring::scenario_cpu
