#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "core/settings.h"

/// How a recording lies in memory and in its file (ours):
///
///     | Title, kTitleSize bytes | half | half |       half: | HalfHead | state | record | record ...
///
/// The halves are used in turn, so that at least one of them is there whenever the process is killed. Each begins
/// with the state of the core (core/archive.h), from which its records go on.
namespace limb_ring::recorder {

constexpr std::array<char, 8> kMagic{'l', 'i', 'm', 'b', 'r', 'e', 'c', '6'};
constexpr std::size_t kTitleSize = 16384;

/// What does not change while a node lives.
struct Title {
  std::uint64_t layout = 0;  ///< core::StateLayout of the program's core
  std::string program;       ///< its version
  std::string ring, node;    ///< names
  std::uint64_t half = 0;    ///< bytes of a half
  std::int64_t zero = 0;     ///< ns, the machine's steady clock at time 0 of the core
  std::int64_t date = 0;     ///< ns since 1970-01-01 then
  core::Settings settings;

  template <class Archive>
  void archive(Archive& a) {
    a("layout", layout)("program", program)("ring", ring)("node", node)("half", half)("zero", zero)("date", date);
    a("settings", settings);
  }
};

struct HalfHead {
  std::atomic<std::uint64_t> generation;  ///< 1, 2, 3 ...; 0 while the state is being written
  std::atomic<std::uint64_t> used;        ///< bytes behind this head that are complete
};
static_assert(sizeof(HalfHead) == 16 && std::atomic<std::uint64_t>::is_always_lock_free);

/// The layout of the state of a core of this program, as in Title::layout.
std::uint64_t state_layout();

}  // namespace limb_ring::recorder
