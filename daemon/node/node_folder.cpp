#include "node/node_folder.h"

#include <chrono>

#include "limb_ring/ring_directory.h"

namespace limb_ring::runtime {

NodeFolder::NodeFolder(const config::RingConfig& ring, const config::NodeConfig& node)
    : ring_(ring),
      node_(node),
      path_(make_ring_directory(ring.ring)),
      lock_(std::in_place, path_, ring.ring, node.id, node.name),
      boots_(std::in_place, path_, node.id) {}

void NodeFolder::make_again() {
  make_ring_directory(ring_.ring);
  if (!is_in_place()) lock_.emplace(path_, ring_.ring, node_.id, node_.name);
  boots_.emplace(path_, node_.id);
}

std::uint64_t NodeFolder::first_boot() const {
  const std::chrono::nanoseconds since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return boots_->first(static_cast<std::uint64_t>(since_1970.count()));
}

}  // namespace limb_ring::runtime
