#pragma once

#include <cstdint>
#include <random>

namespace limb_ring::study {

/// Random numbers of one seed. Whoever draws keeps the order of draws: otherwise seeds would no longer give the same
/// runs as before.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : random_(seed) {}

  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  /// True once in so many times; 0: never.
  bool once_in(unsigned times) { return times != 0 && below(times) == 0; }

 private:
  std::mt19937_64 random_;
};

}  // namespace limb_ring::study
