#include "node/requests.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>

#include "client/arguments.h"
#include "config/quantity.h"
#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "node/event_router.h"
#include "node/fault_requests.h"
#include "wire/packet.h"

namespace limb_ring::runtime {
namespace {

using Action = config::PinConfig::Action;

/// The first pin of a node wired to `action`. @throw RequestError where there is none
std::uint8_t factor_of(const config::NodeConfig& node, Action action, const std::string& name) {
  if (const auto pin = config::first_pin(node, action)) return *pin;
  throw RequestError("node " + node.name + " has no pin wired to " + name);
}

std::string names() {
  std::vector<std::string> names;
  for (const RequestKind& kind : request_kinds()) names.push_back(kind.name);
  return config::join(names);
}

}  // namespace

void Requests::handle(const std::string& text, bool of_cpu, const Answer& answer) {
  using Handler = void (Requests::*)(const Json&, const Answer&);
  using FaultHandler = void (*)(const FaultTargets&, const Json&, const Answer&);
  static const std::map<std::string, Handler> handlers{{"clock", &Requests::clock},       {"config", &Requests::config},
                                                       {"latch", &Requests::latch},       {"ping", &Requests::ping},
                                                       {"reset", &Requests::reset},       {"setup", &Requests::setup},
                                                       {"shutdown", &Requests::shutdown}, {"status", &Requests::status},
                                                       {"stop", &Requests::stop},         {"sync", &Requests::sync}};
  static const std::map<std::string, FaultHandler> fault_handlers{
      {"clear_faults", clear_faults}, {"fault", begin_fault}, {"faults", list_faults}, {"remove_fault", remove_fault}};
  try {
    const Json request = object_in(text, kRequestRule);
    if (!request.contains("do") || !request["do"].is_string()) throw RequestError(kRequestRule);
    const RequestKind* kind = find_request_kind(request);
    if (kind == nullptr)
      throw RequestError("no request '" + request["do"].get<std::string>() + "'; there are " + names());
    require_known_members(request, *kind);
    const auto fault_handler = fault_handlers.find(kind->name);
    if (fault_handler != fault_handlers.end()) return fault_handler->second(to_.faults, request, answer);
    if (kind->name == "stop_latched") return stop_latched(request, of_cpu, answer);
    if (kind->name == "warn") return warn(request, of_cpu, answer);
    const Answer while_here = [answer, here = std::weak_ptr<void>(here_)](const Json& reply) {
      if (!here.expired()) answer(reply);
    };
    if (answer_clock_request(to_.virtual_clock, kind->name, request, while_here)) return;
    (this->*handlers.at(kind->name))(request, answer);
  } catch (const std::exception& error) {
    answer({{"error", error.what()}});
  }
}

bool Requests::changes_something(const std::string& text) {
  const RequestKind* kind = find_request_kind(Json::parse(text, nullptr, /*allow_exceptions=*/false));
  return kind != nullptr && kind->changes_something;
}

void Requests::clock(const Json&, const Answer& answer) {
  Json now{{"now_ns", to_.driver.clock().now().time_since_epoch().count()}};
  if (to_.virtual_clock != nullptr) add_state(*to_.virtual_clock, now);
  answer(now);
}

void Requests::config(const Json&, const Answer& answer) {
  status::Configured all;
  all.ring = to_.ring.ring;
  all.path = to_.ring.path;
  for (const config::NodeConfig& node : to_.ring.nodes) {
    const config::HostConfig* host = to_.ring.host_of(node);
    all.nodes.push_back({node.id, node.name, node.joints.size(), host != nullptr ? host->name : ""});
  }
  for (const config::HostConfig& host : to_.ring.hosts)
    all.hosts.push_back({host.name, host.address, host.ssh_destination()});
  all.folds_back = to_.ring.folds_back();
  all.beacon_ms = to_.ring.timeouts.beacon.count();
  all.cpu_boot_ms = to_.ring.timeouts.cpu_boot.count();
  all.supervisor = config::supervisor_of(to_.ring).id;
  answer(to_json(all));
}

// What firmware needs of its node: by the file that this daemon has read, whatever stands there now.
void Requests::setup(const Json&, const Answer& answer) {
  const config::RingConfig& ring = to_.ring;
  Json joints = Json::array(), sensors = Json::array();
  for (const config::JointConfig& joint : to_.node.joints)
    joints.push_back({{"name", joint.name},
                      {"slides", joint.slides()},
                      {"lower", joint.lower},
                      {"upper", joint.upper},
                      {"velocity", joint.velocity},
                      {"effort", joint.effort},
                      {"initial", joint.initial},
                      {"damps", joint.safe == config::JointConfig::Safe::damp}});
  for (const config::SensorConfig& sensor : to_.node.sensors)
    sensors.push_back({{"name", sensor.name},
                       {"imu", sensor.kind == config::SensorConfig::Kind::imu},
                       {"rate", sensor.rate},
                       {"priority", sensor.priority},
                       {"csv", sensor.csv},
                       {"topic", sensor.topic}});
  answer({{"id", to_.node.id},
          {"name", to_.node.name},
          {"joints", joints},
          {"sensors", sensors},
          {"state_rate", ring.firmware.state_rate},
          {"bandwidth", ring.firmware.bandwidth},
          {"damping", ring.firmware.damping},
          {"command_timeout_ms", ring.timeouts.command.count()},
          {"alive_period_ms", to_.node.cpu.alive_period.count()},
          {"state_to", config::body_of(ring).id}});
}

void Requests::status(const Json& request, const Answer& answer) {
  const Json heard = request.value("heard", Json(true));
  if (!heard.is_boolean()) throw RequestError("heard: " + heard.dump() + " is neither true nor false");
  Json row = to_json(status_row(to_.status, heard));
  if (!heard) row.erase("heard");
  answer(row);
}

// Only the CPU knows: a command that resumes may come too late, or from before the stop.
void Requests::stop_latched(const Json& request, bool of_cpu, const Answer& answer) {
  if (!of_cpu) throw RequestError("stop_latched is for the node's CPU alone");
  const Json latched = request.value("latched", Json());
  if (latched == "never")
    to_.cpu.never_latches_stops();
  else if (latched.is_boolean())
    to_.cpu.stop_latched(latched.get<bool>());
  else
    throw RequestError("'latched' is missing or none of these; allowed: true, false, \"never\"");
  answer(Json::object());
}

void Requests::warn(const Json& request, bool of_cpu, const Answer& answer) {
  constexpr std::size_t kLongest = 1000;
  if (!of_cpu) throw RequestError("warn is for the node's CPU alone");
  const Json text = request.value("text", Json());
  if (!text.is_string() || text.get<std::string>().empty() || text.get<std::string>().size() > kLongest)
    throw RequestError("'text' is missing or none; allowed: a sentence of 1 to 1000 bytes");
  to_.cpu.watch().told(text.get<std::string>());
  answer(Json::object());
}

void Requests::latch(const Json&, const Answer& answer) { answer(to_json(status::latch_of(to_.pins.last_latch()))); }

void Requests::ping(const Json& request, const Answer& answer) {
  TrafficRequest traffic;
  traffic.to = wire::NodeId{node_in(to_.ring, request, "to").id};
  traffic.duration = std::chrono::milliseconds(number_in(request, "duration_ms", 0, 0, 600'000));
  const std::uint64_t count = traffic.duration.count() == 0 ? 10 : Traffic::kMostPackets;
  traffic.count = number_in(request, "count", count, 1, Traffic::kMostPackets);
  traffic.size = number_in(request, "size", wire::kMaxPayload, 1, wire::kMaxPayload);
  traffic.priority = static_cast<std::uint8_t>(number_in(request, "priority", 2, 0, 3));
  traffic.interval = std::chrono::microseconds(number_in(request, "interval_us", 0, 0, 10'000'000));
  traffic.deadline = std::chrono::milliseconds(number_in(request, "deadline_ms", 60'000, 1, 3'600'000));
  if (!to_.traffic.start(traffic, answer))
    throw RequestError("this node makes traffic for " + std::to_string(Traffic::kMostRuns) + " others already");
}

void Requests::reset(const Json& request, const Answer& answer) {
  const config::NodeConfig* target = &node_in(to_.ring, request, "node");
  const std::chrono::milliseconds timeout(number_in(request, "timeout_ms", 3000, 1, 600'000));
  if (target->cpu.kind == config::CpuConfig::Kind::none)
    throw RequestError("node " + target->name + " has no CPU to reset");
  const std::uint8_t factor = factor_of(*target, Action::reset, "reset");
  if (!to_.interrupts.has_room_for_reset())
    throw RequestError("this node waits for " + std::to_string(DaemonInterrupts::kMostResets) + " resets already");
  to_.interrupts.reset(wire::NodeId{target->id}, factor, timeout, [this, answer](const watchdog::ResetReport& report) {
    const SendReason reason = to_.reasons.of(report.ended);
    const bool explained = report.ended.outcome != core::Outcome::delivered && !report.success();
    answer({{"success", report.success()},
            {"effect", to_string(report.effect)},
            {"outcome", core::to_string(report.ended.outcome)},
            {"reason", reason.text},
            {"reason_code", to_string(reason.reason)},
            {"message", report.message + (explained && !reason.text.empty() ? ": " + reason.text : "")},
            {"round_trip_us", statistics::microseconds(report.ended.round_trip)},
            {"boots", report.boots},
            {"confirmed_ms", std::chrono::duration_cast<std::chrono::milliseconds>(report.lasted).count()}});
  });
}

// A broadcast is not received by its source (paper), but "stop all" means this CPU too.
void Requests::stop(const Json& request, const Answer& answer) {
  const std::uint8_t to = nodes_in(to_.ring, request, "node");
  const config::NodeConfig& target = to == wire::kBroadcast ? to_.node : *to_.ring.find(to);
  const std::uint8_t factor = factor_of(target, Action::stop, "stop");
  if (to == wire::kBroadcast) to_.events.pull(factor, to_.node.id, to_.driver.clock().now().time_since_epoch().count());
  to_.interrupts.interrupt(wire::NodeId{to}, factor,
                           [this, answer](const core::SendEnded& ended) { answer(end_of(ended)); });
}

void Requests::sync(const Json&, const Answer& answer) {
  const std::uint8_t factor = factor_of(to_.node, Action::sync, "sync");
  const std::int64_t clock = to_.driver.clock().now().time_since_epoch().count();
  to_.events.pull(factor, to_.node.id, clock);
  to_.interrupts.interrupt(wire::kBroadcast, factor, [this, answer, clock](const core::SendEnded& ended) {
    Json end = end_of(ended);
    end["ring_size"] = to_.driver.controller().membership().ring_size();
    end["clock_ns"] = clock;
    const std::int64_t now = to_.driver.clock().now().time_since_epoch().count();
    // The core's time of a send is that of the first slice of the turn, which may be before `clock` was read.
    end["left_ns"] = std::max(clock, now - core::whole_nanoseconds(ended.round_trip).count());
    answer(end);
  });
}

// As SIGTERM would: the one way to end cleanly.
void Requests::shutdown(const Json&, const Answer& answer) {
  answer(Json::object());
  ::kill(::getpid(), SIGTERM);
}

nlohmann::json Requests::end_of(const core::SendEnded& ended) const {
  const SendReason reason = to_.reasons.of(ended);
  return {{"outcome", to_string(public_outcome(ended.outcome))},
          {"reason", reason.text},
          {"reason_code", to_string(reason.reason)},
          {"round_trip_us", statistics::microseconds(ended.round_trip)},
          {"tries", ended.tries}};
}

namespace {

std::string word(const nlohmann::json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

std::string names_of(const config::RingConfig& ring) {
  std::string names;
  for (const auto& node : ring.nodes) names += (names.empty() ? "" : ", ") + std::to_string(node.id) + " " + node.name;
  return names;
}

}  // namespace

std::string text_of(const nlohmann::json& answer) {
  return answer.dump(-1, ' ', /*ensure_ascii=*/false, nlohmann::json::error_handler_t::replace);
}

nlohmann::json object_in(const std::string& text, const char* problem) {
  if (const auto deep = client::json_problem(text)) throw RequestError(*deep);
  nlohmann::json object = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!object.is_object()) throw RequestError(problem);
  return object;
}

std::optional<std::string> unknown_member(const nlohmann::json& object, const std::vector<std::string>& known) {
  for (const auto& [member, value] : object.items())
    if (std::find(known.begin(), known.end(), member) == known.end()) return config::printable(member);
  return std::nullopt;
}

std::uint64_t number_in(const nlohmann::json& request, const std::string& field, std::uint64_t otherwise,
                        std::uint64_t least, std::uint64_t most) {
  if (!request.contains(field)) return otherwise;
  const auto& value = request[field];
  if (value.is_number_integer() && value.get<std::int64_t>() >= 0 && value.get<std::uint64_t>() >= least &&
      value.get<std::uint64_t>() <= most)
    return value.get<std::uint64_t>();
  throw RequestError(field + ": " + word(value) + " is not a whole number from " + std::to_string(least) + " to " +
                     std::to_string(most));
}

const config::NodeConfig& node_in(const config::RingConfig& ring, const nlohmann::json& request,
                                  const std::string& field) {
  if (!request.contains(field)) throw RequestError(field + " is missing: a node's id or name");
  const config::NodeConfig* node = ring.find(word(request[field]));
  if (node == nullptr)
    throw RequestError(field + ": ring " + ring.ring + " has no node '" + word(request[field]) +
                       "'; it has: " + names_of(ring));
  return *node;
}

std::uint8_t nodes_in(const config::RingConfig& ring, const nlohmann::json& request, const std::string& field) {
  if (!request.contains(field) || request[field] == "all") return wire::kBroadcast;
  return node_in(ring, request, field).id;
}

const std::vector<RequestKind>& request_kinds() {
  static const std::vector<RequestKind> kinds{
      {"allow", {"outer_zero_ns", "until_ns"}, false},
      {"clear_faults", {}, true},
      {"clock", {}, false},
      {"config", {}, false},
      {"fault", {"fault"}, true},
      {"faults", {}, false},
      {"latch", {}, false},
      {"pace", {"pace"}, false},
      {"pause", {}, false},
      {"ping", {"count", "deadline_ms", "duration_ms", "interval_us", "priority", "size", "to"}, true},
      {"remove_fault", {"id"}, true},
      {"reset", {"node", "timeout_ms"}, true},
      {"run", {}, false},
      {"setup", {}, false},
      {"shutdown", {}, false},
      {"status", {"heard"}, false},
      {"step", {"time_ns"}, false},
      {"stop", {"node"}, true},
      {"stop_latched", {"latched"}, false},
      {"sync", {}, true},
      {"warn", {"text"}, false},
      {"went_on_without", {"whom"}, false}};
  return kinds;
}

const RequestKind* find_request_kind(const nlohmann::json& request) {
  const auto name = request.find("do");
  if (name == request.end() || !name->is_string()) return nullptr;
  const auto& kinds = request_kinds();
  const auto found =
      std::find_if(kinds.begin(), kinds.end(), [&](const RequestKind& kind) { return *name == kind.name; });
  return found == kinds.end() ? nullptr : &*found;
}

void require_known_members(const nlohmann::json& request, const RequestKind& kind) {
  std::vector<std::string> known = kind.members;
  known.emplace_back("do");
  if (const auto unknown = unknown_member(request, known))
    throw RequestError(kind.name + ": '" + *unknown + "' is unknown; " +
                       (kind.members.empty() ? "it takes nothing" : "it takes: " + config::join(kind.members)));
}

}  // namespace limb_ring::runtime
