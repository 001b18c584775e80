#include "node/observers.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "client/arguments.h"
#include "config/ring_config.h"
#include "node/requests.h"
#include "wire/packet.h"

namespace limb_ring::runtime {

void Observers::set(host::ClientId client, const std::set<std::string>& kinds) {
  told_ = {};
  if (kinds.empty()) return remove(client);
  wanted_[client] = kinds;
}

bool Observers::wants(const std::string& kind) const {
  return std::any_of(wanted_.begin(), wanted_.end(),
                     [&](const auto& client) { return client.second.count(kind) != 0; });
}

void Observers::tell(const std::string& kind, nlohmann::json what) {
  if (!wants(kind)) return;
  what["kind"] = kind;
  what["time_ns"] = clock_.wall_ns(clock_.now());
  const std::string line = text_of(what);
  for (const auto& [client, kinds] : wanted_)
    if (kinds.count(kind) != 0) host_.observed(client, line);
}

void Observers::tell_changes(const NodeDriver& driver) {
  if (!any()) return;
  Figures now;
  now.ring_size = driver.controller().membership().ring_size();
  now.crc_errors = driver.controller().counters().crc_errors;
  now.line_corrupted = driver.breaker(core::Line::first).counters().line_corrupted;
  const Figures before = std::exchange(told_, now);
  if (now.ring_size != before.ring_size) tell("ring", {{"ring_size", now.ring_size}});
  if (now.crc_errors != before.crc_errors || now.line_corrupted != before.line_corrupted)
    tell("noise", {{"crc_errors", now.crc_errors}, {"line_corrupted", now.line_corrupted}});
}

namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

const Words kKinds{"data", "control", "interrupt"};  // by capture::Kind
const Words kLines{"in", "out"};
constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();

const Words kMembers{"kinds", "packets", "promises"};
const Words kOfPackets{"at", "kinds", "source", "destination", "priority", "channel", "sample", "limit_per_s"};

void refuse_unknown(const json& from, const Words& allowed, const std::string& what) {
  if (const auto unknown = unknown_member(from, allowed))
    throw RequestError(what + ": '" + *unknown + "' is unknown; there are " + config::join(allowed));
}

json list_in(const json& from, const char* field) {
  if (!from.contains(field)) return json::array();
  if (!from[field].is_array()) throw RequestError(std::string("observe: ") + field + " is a list");
  return from[field];
}

std::set<std::size_t> words_in(const json& from, const char* field, const Words& allowed) {
  std::set<std::size_t> found;
  for (const json& word : list_in(from, field)) {
    const auto place = std::find(allowed.begin(), allowed.end(), word.is_string() ? word.get<std::string>() : "");
    if (place == allowed.end())
      throw RequestError(std::string("observe: ") + field + ": there is no " + word.dump() + "; there are " +
                         config::join(allowed));
    found.insert(static_cast<std::size_t>(place - allowed.begin()));
  }
  return found;
}

template <std::size_t N>
std::bitset<N> numbers_in(const json& from, const char* field) {
  std::bitset<N> found;
  for (const json& number : list_in(from, field)) found.set(number_in({{field, number}}, field, 0, 0, N - 1));
  return found;
}

/// A source may be an id that is not configured: so stray packets can be found.
std::bitset<256> nodes_of(const config::RingConfig& ring, const json& from, const char* field) {
  std::bitset<256> found;
  for (const json& node : list_in(from, field))
    found.set(node.is_number() ? number_in({{field, node}}, field, 0, 0, 255) : nodes_in(ring, {{field, node}}, field));
  return found;
}

capture::Choice choice_of(const config::RingConfig& ring, const json& packets) {
  if (!packets.is_object()) throw RequestError("observe: packets is an object");
  refuse_unknown(packets, kOfPackets, "observe: packets");
  capture::Choice choice;
  if (const auto at = words_in(packets, "at", kLines); !at.empty()) {
    choice.filter.input = at.count(0) != 0;
    choice.filter.output = at.count(1) != 0;
  }
  for (const std::size_t kind : words_in(packets, "kinds", kKinds)) choice.filter.kinds.set(kind);
  choice.filter.source = nodes_of(ring, packets, "source");
  choice.filter.destination = nodes_of(ring, packets, "destination");
  choice.filter.priority = numbers_in<4>(packets, "priority");
  choice.filter.channel = numbers_in<64>(packets, "channel");
  choice.sample = static_cast<std::uint32_t>(number_in(packets, "sample", 1, 1, kMost));
  choice.limit_per_s = static_cast<std::uint32_t>(number_in(packets, "limit_per_s", 0, 0, kMost));
  return choice;
}

}  // namespace

ObserveFilter read_observe_filter(const config::RingConfig& ring, const std::string& text) {
  const json order = object_in(text.empty() ? "{}" : text, "an observe filter is a JSON object");
  refuse_unknown(order, kMembers, "observe");
  ObserveFilter read;
  const Words& events = client::event_kinds();
  for (const std::size_t kind : words_in(order, "kinds", events)) read.kinds.insert(events[kind]);
  const bool packets = order.contains("packets");
  if (order.contains("promises")) {
    if (!order["promises"].is_boolean()) throw RequestError("observe: promises is true or false");
    read.promises = order["promises"].get<bool>();
  }
  if (read.kinds.empty() && !packets && !order.contains("promises")) read.kinds.insert(events.begin(), events.end());
  if (packets && !order["packets"].is_null()) read.packets = choice_of(ring, order["packets"]);
  return read;
}

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

PromiseObservers::PromiseObservers(wire::NodeId self, std::string folder, NodeDriver& driver, host::HostServer& host)
    : path_(std::move(folder) + '/' + std::to_string(self) + ".watch"), driver_(driver), host_(host) {}

void PromiseObservers::set(host::ClientId client, bool wanted) {
  if (!wanted) return remove(client);
  if (!file_) start();
  put_back();
  clients_.insert(client);
  tell(client);
}

void PromiseObservers::remove(host::ClientId client) {
  clients_.erase(client);
  if (clients_.empty()) stop();
}

void PromiseObservers::start() {
  using std::chrono::nanoseconds;
  const core::NetworkController& controller = driver_.controller();
  const auto zero = std::chrono::duration_cast<nanoseconds>(driver_.steady(core::Time{}).time_since_epoch());
  file_ = std::make_unique<promises::ObservationFile>(path_);
  observer_ = std::make_unique<promises::NodeObserver>(
      controller.settings(), zero, [this] { return driver_.controller().received_waiting(); }, *file_);
  driver_.set_journal(observer_.get());
}

bool PromiseObservers::is_in_place() const { return !file_ || file_->is_there(); }

void PromiseObservers::put_back() {
  if (is_in_place()) return;
  file_->make_again();
  for (const host::ClientId client : clients_) tell(client);
}

void PromiseObservers::stop() {
  if (!file_) return;
  driver_.set_journal(nullptr);
  observer_.reset();
  file_.reset();
}

void PromiseObservers::tell(host::ClientId client) {
  const core::NetworkController& controller = driver_.controller();
  const nlohmann::json where{{"kind", "promises"},
                             {"path", file_->path()},
                             {"from", file_->count()},
                             {"state", static_cast<unsigned>(controller.membership().state())},
                             {"at_ns", driver_.steady(driver_.now()).time_since_epoch().count()},
                             {"longest_send_ns", promises::longest_send(controller.settings()).count()}};
  host_.observed(client, text_of(where));
}

}  // namespace limb_ring::runtime
