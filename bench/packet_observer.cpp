#include "bench/packet_observer.h"

#include <fstream>
#include <stdexcept>

#include "bench/cores.h"
#include "bench/waits.h"
#include "wire/pcapng_writer.h"

namespace limb_ring::bench {
namespace {

void observe(HostPort port, std::atomic<bool>& ready) {
  std::ofstream nowhere("/dev/null");
  capture::PcapngWriter writer(nowhere, {port.ring(), {}});
  port.observe(R"({"packets": {}})");
  while (port.connected()) {
    const auto message = port.receive(std::chrono::seconds(1));
    if (!message) continue;
    if (std::holds_alternative<CaptureCounts>(*message)) ready = true;  // the first: the daemon has begun
    const auto* packet = std::get_if<CapturedPacket>(&*message);
    if (packet == nullptr) continue;
    writer.packet(packet->time_ns, packet->info, {packet->bytes.data(), packet->bytes.size()}, packet->lost_before);
  }
}

}  // namespace

PacketObserver::PacketObserver(const Setup& setup, const PrivateRing& ring, std::size_t index, Pinning pinning)
    : ready_(std::make_unique<Shared<std::atomic<bool>>>(1)) {
  std::atomic<bool>& ready = (*ready_)[0];
  worker_ = std::make_unique<Worker>([&] {
    stay_on(cores_for(pinning));
    observe(ring.connect(index), ready);
  });
  if (!worker_->sets(ready, setup.poll, kPatience))
    throw std::runtime_error("the packets of a node could not be observed");
}

}  // namespace limb_ring::bench
