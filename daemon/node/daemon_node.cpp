#include "node/daemon_node.h"

#include "config/core_settings.h"
#include "io/packet_loop.h"
#include "node/engine.h"
#include "node/re_exec.h"

namespace limb_ring::runtime {
namespace {

/// Where the daemon is to be pinned.
std::optional<cpu_set_t> own_cores(const config::RingConfig& ring) {
  cpu_set_t cores;
  const bool pinned = ring.realtime.auto_cores || !ring.realtime.cores.empty();
  if (!pinned || ::sched_getaffinity(0, sizeof cores, &cores) != 0) return std::nullopt;
  return cores;
}

recorder::Title title_of(const config::RingConfig& ring, const config::NodeConfig& node) {
  recorder::Title title;
  title.ring = ring.ring;
  title.node = node.name;
  return title;
}

}  // namespace

NodeBase daemon_base(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& node) {
  const auto cores = own_cores(ring);
  NodeBase base;
  base.make_driver = [&io, &ring, &node](const NodeFolder& folder, DriverListener& listener) {
    auto engine = std::make_unique<Engine>(io, setup::core_settings(ring, node, folder.first_boot()),
                                           setup::link_settings(ring, node, folder.path()), listener);
    if (ring.recorder.enabled)
      engine->record(recorder::recording_of(folder.path(), node.id), ring.recorder.size, title_of(ring, node));
    return engine;
  };
  base.start_anew = [&io, cores] {
    event_loop::PacketLoop::of(io).end_core_sharing();
    re_exec(cores);
  };
  if (!ring.realtime.auto_cores) base.cpu_cores = cores;  // else the CPU stays beside its controller
  return base;
}

}  // namespace limb_ring::runtime
