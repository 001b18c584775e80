#include "node/cpu_socket.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "limb_ring/payload/packet_type.h"

namespace limb_ring::runtime {
namespace {

constexpr const char* kReset = "the CPU was reset";

}  // namespace

CpuSocket::CpuSocket(boost::asio::io_context& io, CpuOptions options, const config::RingConfig& ring,
                     const config::NodeConfig& node, NodeDriver& driver, host::HostServer& host,
                     std::function<void()> changed)
    : kind_(options.cpu.kind),
      alive_period_(options.cpu.alive_period),
      driver_(driver),
      host_(host),
      changed_(std::move(changed)),
      log_prefix_(options.log_prefix),
      watch_(ring, node, [prefix = log_prefix_](const std::string& text) { spdlog::warn("{}{}", prefix, text); }),
      process_(io, driver.clock(), std::move(options), *this),
      next_read_(driver.clock().timer([this] {
        hand_over();
        driver_.pump();
      })) {}

void CpuSocket::start() {
  process_.start();
  driver_.set_cpu_present(is_sink());
  if (process_.status().kind != CpuKind::child) report();  // a child's start calls on_cpu_changed(), which reports
}

std::optional<std::string> CpuSocket::attach(const host::ClientInfo& client) {
  if (is_sink()) return "this node is configured with 'cpu: none'; 'cpu: attached' would let a process be its CPU";
  // The longer period counts: a healthy CPU that speaks as often as the ring's file says must not be called hung.
  const auto alive_period = std::max(client.alive_period, alive_period_);
  if (!process_.attached(client.pid, client.restarted_by_owner, alive_period))
    return "this process has ended or is being reset";
  reported_.spoke_at = driver_.now();  // its greeting was its first word
  watch_.begin(driver_.now());
  driver_.set_cpu_present(true);
  return std::nullopt;
}

// Packets that waited for the old CPU are stale for the next one, so they are dropped.
void CpuSocket::detach(const host::ClientInfo& client) {
  process_.detached(client.pid);
  if (host_.cpu() != nullptr && host_.cpu()->id != client.id) return;
  forget(client);
}

void CpuSocket::spoke() {
  watch_.spoke(driver_.now());
  process_.spoke(driver_.clock().now());
  change_report([&](core::CpuReport& report) { report.spoke_at = driver_.now(); });
}

void CpuSocket::hand_over() {
  core::ReceivedPacket packet;
  while (read_throttle_.may_take(driver_.now()) && (is_sink() || host_.cpu_can_take()) && driver_.take(packet)) {
    read_throttle_.took(driver_.now());
    if (is_sink()) continue;
    const client::PacketView view{packet.source, packet.destination, packet.priority, packet.channel, packet.bytes()};
    if (view.channel == payload::kJointChannel) watch_.given({view.data.data, view.data.size});
    host_.give(view);
  }
  // If that time is over already, the CPU has asked for nothing more: it is given more when it does.
  const core::Time next = read_throttle_.next();
  if (next != core::kNever && next > driver_.now() && driver_.controller().received_waiting() != 0)
    next_read_->expires_at(driver_.steady(next));
}

CpuActionResult CpuSocket::reset(const std::string& reason) {
  if (is_sink()) {
    ++sink_boots_;
    ++sink_resets_;
    driver_.cpu_reset(core::kController);
    report();
    return {true, true, "the built-in sink was reset"};
  }
  const CpuActionResult done = process_.reset(reason);
  drop_client();
  if (done.done) host_.disconnect_booting_cpu(kReset);
  return done;
}

void CpuSocket::drop_client() {
  if (host_.cpu() == nullptr) return;
  const host::ClientInfo client = *host_.cpu();
  forget(client);
  host_.disconnect(client.id, kReset);
}

void CpuSocket::forget(const host::ClientInfo& client) {
  if (stop_.latched) spdlog::warn("{}the stop of this node ends, because its CPU has ended", log_prefix_);
  stop_latched(false);
  stop_.latches = true;
  watch_.end();
  driver_.set_cpu_present(false);
  driver_.cpu_reset(client.id);
}

void CpuSocket::interrupt(limb_ring::Interrupt::Action action, std::uint8_t source, std::uint8_t factor) {
  if (action == limb_ring::Interrupt::Action::stop) {
    ++stop_.pulled;
    stop_.pulled_at = driver_.now();
  }
  if (!is_sink()) host_.interrupt({action, source, factor});
}

void CpuSocket::stop_latched(bool latched) {
  if (latched == stop_.latched) return;
  stop_.latched = latched;
  change_report([&](core::CpuReport& report) { report.stop_latched = latched; });
  driver_.pump();
}

void CpuSocket::clock_latched(const wire::ClockLatch& latch) {
  change_report([&](core::CpuReport& report) { report.latch = latch; });
}

CpuStatus CpuSocket::status() const {
  CpuStatus status = process_.status();
  if (!is_sink()) return status;
  status.boots = sink_boots_;
  status.resets = sink_resets_;
  status.restarted_by_owner = true;
  return status;
}

void CpuSocket::on_cpu_changed() { report(); }

void CpuSocket::report() {
  const CpuStatus now = status();
  if (now.unsettled) return changed_();
  change_report([&](core::CpuReport& report) {
    report.boots = now.boots;
    report.state = now.state;
    report.comes_back = now.kind != CpuKind::attached || now.restarted_by_owner;
  });
  changed_();
  driver_.pump();
}

}  // namespace limb_ring::runtime
