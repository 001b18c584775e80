#include "bare_loop.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <queue>
#include <vector>

#include "load.h"
#include "stopwatch.h"
#include "wire/checksum.h"
#include "wire/packet.h"

namespace limb_ring::hops {

namespace {

using Time = std::chrono::nanoseconds;
using Bytes = std::vector<std::uint8_t>;

struct Hop {
  Time at;
  std::uint64_t order;
  unsigned node;
  bool operator>(const Hop& other) const { return at != other.at ? at > other.at : order > other.order; }
};

class BareRing {
 public:
  explicit BareRing(unsigned nodes)
      : lines_(nodes, Bytes(wire::kMaxDataPacketSize, 0x5A)), buffers_(lines_), free_at_(nodes), order_(nodes) {
    for (unsigned node = 0; node < nodes; ++node) events_.push({Time{0}, node, node});
  }

  /// A packet takes its place behind what is on the line, as in a saturated ring.
  void hop() {
    const Hop hop = events_.top();
    events_.pop();
    const unsigned next = (hop.node + 1) % static_cast<unsigned>(lines_.size());
    carry(hop.node, next);
    const Time start = std::max(hop.at, free_at_[hop.node]);
    free_at_[hop.node] = start + kPacket;
    events_.push({start + kDelay, order_++, next});
  }
  std::uint32_t crcs() const { return crcs_; }

 private:
  void carry(unsigned node, unsigned next) {
    Bytes& buffer = buffers_[node];
    std::memcpy(buffer.data(), lines_[node].data(), buffer.size());
    crcs_ ^= wire::crc32({buffer.data(), buffer.size() - wire::kCrcSize});
    std::memcpy(lines_[next].data(), buffer.data(), buffer.size());
  }

  std::vector<Bytes> lines_, buffers_;
  std::vector<Time> free_at_;
  std::priority_queue<Hop, std::vector<Hop>, std::greater<Hop>> events_;
  std::uint64_t order_;
  std::uint32_t crcs_ = 0;
};

}  // namespace

double bare_loop(unsigned nodes, std::uint64_t hops) {
  BareRing ring(nodes);
  const Stopwatch watch;
  for (std::uint64_t i = 0; i < hops; ++i) ring.hop();
  const double seconds = watch.seconds();
  volatile std::uint32_t kept = ring.crcs();  // or the compiler would leave the CRCs out
  static_cast<void>(kept);
  return static_cast<double>(hops) / seconds;
}

}  // namespace limb_ring::hops
