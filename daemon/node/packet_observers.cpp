#include "node/packet_observers.h"

namespace limb_ring::runtime {

using Instant = LineTap::Time;

PacketObservers::PacketObservers(wire::NodeId self, NodeDriver& driver, host::HostServer& host)
    : self_(self),
      driver_(driver),
      host_(host),
      input_([this](const capture::PacketView& packet) { seen(packet); }),
      output_([this](const capture::PacketView& packet) { seen(packet); }) {}

void PacketObservers::set(host::ClientId client, const std::optional<capture::Choice>& choice) {
  const auto found = observers_.find(client);
  if (found != observers_.end()) {
    host_.capture_counts(client, found->second.selection.counts());
    observers_.erase(found);
  }
  if (choice) {
    observers_.emplace(client, Observer{capture::Selection(*choice)});
    host_.capture_counts(client, {});
  }
  update_taps();
}

void PacketObservers::remove(host::ClientId client) {
  observers_.erase(client);
  update_taps();
}

void PacketObservers::update_taps() {
  watch_input_ = watch_output_ = false;
  for (const auto& [client, observer] : observers_) {
    watch_input_ = watch_input_ || observer.selection.filter().input;
    watch_output_ = watch_output_ || observer.selection.filter().output;
  }
  if (!watch_input_) input_.reset();
  if (!watch_output_) output_.reset();
  driver_.set_tap(observers_.empty() ? nullptr : this);
}

// ---- the lines ----------------------------------------------------------------------------

void PacketObservers::on_input(const wire::Slice& slice, wire::NodeId from, Instant at) {
  if (!watch_input_) return;
  input_.set_line(true, from, self_);
  input_.put(slice, at.time_since_epoch());
}

void PacketObservers::on_output(wire::ByteView framed_slices, wire::NodeId to, Instant at) {
  if (!watch_output_) return;
  output_.set_line(false, self_, to);
  wire::each_slice(framed_slices, [&](const wire::Slice& slice) { output_.put(slice, at.time_since_epoch()); });
}

void PacketObservers::on_input_gap(Instant at) { input_.gap(at.time_since_epoch()); }

void PacketObservers::on_output_gap(Instant at) { output_.gap(at.time_since_epoch()); }

// ---- the observers ------------------------------------------------------------------------

void PacketObservers::seen(const capture::PacketView& packet) {
  for (auto& [client, observer] : observers_)
    if (observer.selection.takes(packet)) give(client, observer, packet);
}

void PacketObservers::give(host::ClientId client, Observer& observer, const capture::PacketView& packet) {
  capture::Selection& selection = observer.selection;
  const std::int64_t time = driver_.clock().wall_ns(Instant(packet.at));
  if (!host_.captured(client, {time, selection.lost_before(), packet})) return selection.lost();
  selection.given();
  if (packet.at - observer.told_at < std::chrono::seconds(1)) return;
  observer.told_at = packet.at;
  host_.capture_counts(client, selection.counts());
}

}  // namespace limb_ring::runtime
