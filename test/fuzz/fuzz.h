#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "wire/bytes.h"

/// One input of the parser under test, in each file of this folder. It must neither crash nor break what require()
/// asks. libFuzzer calls it (`make fuzz`), and kept_inputs.cpp in every build.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace limb_ring::fuzz {

/// Ends the run, and says what is broken, where `holds` is false.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

/// Takes numbers off the front of an input: what is not there is 0.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_{data, size} {}
  bool empty() const { return rest_.empty(); }
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t value = rest_[0];
    rest_ = rest_.from(1);
    return value;
  }
  /// At most so many bytes.
  wire::ByteView bytes(std::size_t most) {
    const wire::ByteView taken = rest_.first(most < rest_.size ? most : rest_.size);
    rest_ = rest_.from(taken.size);
    return taken;
  }

 private:
  wire::ByteView rest_;
};

}  // namespace limb_ring::fuzz
