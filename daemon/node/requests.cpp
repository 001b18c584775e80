#include "node/requests.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
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

using Json = nlohmann::json;
using Targets = Requests::Targets;
using Action = config::PinConfig::Action;

/// The first pin of a node wired to `action`. @throw RequestError if there is none
std::uint8_t factor_of(const config::NodeConfig& node, Action action, const std::string& name) {
  if (const auto pin = config::first_pin(node, action)) return *pin;
  throw RequestError("node " + node.name + " has no pin wired to " + name);
}

Json end_of(const Targets& to, const core::SendEnded& ended) {
  const SendReason reason = to.reasons.of(ended);
  return {{"outcome", to_string(public_outcome(ended.outcome))},
          {"reason", reason.text},
          {"reason_code", to_string(reason.reason)},
          {"round_trip_us", statistics::microseconds(ended.round_trip)},
          {"tries", ended.tries}};
}

namespace node_requests {

void clock(const Targets& to, const Json&, const Answer& answer) {
  Json now{{"now_ns", to.driver.clock().now().time_since_epoch().count()}};
  if (to.virtual_clock != nullptr) add_state(*to.virtual_clock, now);
  answer(now);
}

void config(const Targets& to, const Json&, const Answer& answer) {
  status::Configured all;
  all.ring = to.ring.ring;
  all.path = to.ring.path;
  for (const config::NodeConfig& node : to.ring.nodes) {
    const config::HostConfig* host = to.ring.host_of(node);
    all.nodes.push_back({node.id, node.name, node.joints.size(), host != nullptr ? host->name : ""});
  }
  for (const config::HostConfig& host : to.ring.hosts)
    all.hosts.push_back({host.name, host.address, host.ssh_destination()});
  all.folds_back = to.ring.folds_back();
  all.beacon_ms = to.ring.timeouts.beacon.count();
  all.cpu_boot_ms = to.ring.timeouts.cpu_boot.count();
  all.supervisor = config::supervisor_of(to.ring).id;
  answer(to_json(all));
}

// What firmware needs of its node: by the file that this daemon has read, whatever stands there now.
void setup(const Targets& to, const Json&, const Answer& answer) {
  const config::RingConfig& ring = to.ring;
  Json joints = Json::array(), sensors = Json::array();
  for (const config::JointConfig& joint : to.node.joints)
    joints.push_back({{"name", joint.name},
                      {"slides", joint.slides()},
                      {"lower", joint.lower},
                      {"upper", joint.upper},
                      {"velocity", joint.velocity},
                      {"effort", joint.effort},
                      {"initial", joint.initial},
                      {"damps", joint.safe == config::JointConfig::Safe::damp}});
  for (const config::SensorConfig& sensor : to.node.sensors)
    sensors.push_back({{"name", sensor.name},
                       {"imu", sensor.kind == config::SensorConfig::Kind::imu},
                       {"rate", sensor.rate},
                       {"priority", sensor.priority},
                       {"csv", sensor.csv},
                       {"topic", sensor.topic}});
  answer({{"id", to.node.id},
          {"name", to.node.name},
          {"joints", joints},
          {"sensors", sensors},
          {"state_rate", ring.firmware.state_rate},
          {"bandwidth", ring.firmware.bandwidth},
          {"damping", ring.firmware.damping},
          {"command_timeout_ms", ring.timeouts.command.count()},
          {"alive_period_ms", to.node.cpu.alive_period.count()},
          {"state_to", config::body_of(ring).id}});
}

void status(const Targets& to, const Json& request, const Answer& answer) {
  const Json heard = request.value("heard", Json(true));
  if (!heard.is_boolean()) throw RequestError("heard: " + heard.dump() + " is neither true nor false");
  Json row = to_json(status_row(to.status, heard));
  if (!heard) row.erase("heard");
  answer(row);
}

// Only the CPU knows: a command that resumes may come too late, or from before the stop.
void stop_latched(const Targets& to, const Json& request, const Answer& answer) {
  const Json latched = request.value("latched", Json());
  if (latched == "never")
    to.cpu.never_latches_stops();
  else if (latched.is_boolean())
    to.cpu.stop_latched(latched.get<bool>());
  else
    throw RequestError("'latched' is missing or wrong; allowed: true, false, \"never\"");
  answer(Json::object());
}

void warn(const Targets& to, const Json& request, const Answer& answer) {
  constexpr std::size_t kLongest = 1000;
  const Json text = request.value("text", Json());
  if (!text.is_string() || text.get<std::string>().empty() || text.get<std::string>().size() > kLongest)
    throw RequestError("'text' is missing or wrong; allowed: a sentence of 1 to 1000 bytes");
  to.cpu.watch().told(text.get<std::string>());
  answer(Json::object());
}

void latch(const Targets& to, const Json&, const Answer& answer) {
  answer(to_json(status::latch_of(to.pins.last_latch())));
}

void ping(const Targets& to, const Json& request, const Answer& answer) {
  TrafficRequest traffic;
  traffic.to = wire::NodeId{node_in(to.ring, request, "to").id};
  traffic.duration = std::chrono::milliseconds(number_in(request, "duration_ms", 0, 0, 600'000));
  const std::uint64_t count = traffic.duration.count() == 0 ? 10 : Traffic::kMostPackets;
  traffic.count = number_in(request, "count", count, 1, Traffic::kMostPackets);
  traffic.size = number_in(request, "size", wire::kMaxPayload, 1, wire::kMaxPayload);
  traffic.priority = static_cast<std::uint8_t>(number_in(request, "priority", 2, 0, 3));
  traffic.interval = std::chrono::microseconds(number_in(request, "interval_us", 0, 0, 10'000'000));
  traffic.deadline = std::chrono::milliseconds(number_in(request, "deadline_ms", 60'000, 1, 3'600'000));
  if (!to.traffic.start(traffic, answer))
    throw RequestError("this node makes traffic for " + std::to_string(Traffic::kMostRuns) + " others already");
}

void reset(const Targets& to, const Json& request, const Answer& answer) {
  const config::NodeConfig* target = &node_in(to.ring, request, "node");
  const std::chrono::milliseconds timeout(number_in(request, "timeout_ms", 3000, 1, 600'000));
  if (target->cpu.kind == config::CpuConfig::Kind::none)
    throw RequestError("node " + target->name + " has no CPU to reset");
  const std::uint8_t factor = factor_of(*target, Action::reset, "reset");
  if (!to.interrupts.has_room_for_reset())
    throw RequestError("this node waits for " + std::to_string(DaemonInterrupts::kMostResets) + " resets already");
  to.interrupts.reset(wire::NodeId{target->id}, factor, timeout, [&to, answer](const watchdog::ResetReport& report) {
    const SendReason reason = to.reasons.of(report.ended);
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
void stop(const Targets& to, const Json& request, const Answer& answer) {
  const std::uint8_t whom = nodes_in(to.ring, request, "node");
  const config::NodeConfig& target = whom == wire::kBroadcast ? to.node : *to.ring.find(whom);
  const std::uint8_t factor = factor_of(target, Action::stop, "stop");
  if (whom == wire::kBroadcast) to.events.pull(factor, to.node.id, to.driver.clock().now().time_since_epoch().count());
  to.interrupts.interrupt(wire::NodeId{whom}, factor,
                          [&to, answer](const core::SendEnded& ended) { answer(end_of(to, ended)); });
}

void sync(const Targets& to, const Json&, const Answer& answer) {
  const std::uint8_t factor = factor_of(to.node, Action::sync, "sync");
  const std::int64_t clock = to.driver.clock().now().time_since_epoch().count();
  to.events.pull(factor, to.node.id, clock);
  to.interrupts.interrupt(wire::kBroadcast, factor, [&to, answer, clock](const core::SendEnded& ended) {
    Json end = end_of(to, ended);
    end["ring_size"] = to.driver.controller().membership().ring_size();
    end["clock_ns"] = clock;
    const std::int64_t now = to.driver.clock().now().time_since_epoch().count();
    // The core's time of a send is that of the first slice of the turn, which may be before `clock` was read.
    end["left_ns"] = std::max(clock, now - core::whole_nanoseconds(ended.round_trip).count());
    answer(end);
  });
}

// As SIGTERM would: the one way to end cleanly.
void shutdown(const Targets&, const Json&, const Answer& answer) {
  answer(Json::object());
  ::kill(::getpid(), SIGTERM);
}

}  // namespace node_requests

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

namespace {

using Changes = RequestKind::Changes;
using For = RequestKind::For;

// clang-format off
const std::vector<RequestKind> kRequests{
    // do               further members                      changes           for          answered by
    {"allow",           {"outer_zero_ns", "until_ns"},       Changes::nothing, For::anyone, clock_requests::allow},
    {"clear_faults",    {},                                  Changes::ring,    For::anyone, clear_faults},
    {"clock",           {},                                  Changes::nothing, For::anyone, node_requests::clock},
    {"config",          {},                                  Changes::nothing, For::anyone, node_requests::config},
    {"fault",           {"fault"},                           Changes::ring,    For::anyone, begin_fault},
    {"faults",          {},                                  Changes::nothing, For::anyone, list_faults},
    {"latch",           {},                                  Changes::nothing, For::anyone, node_requests::latch},
    {"pace",            {"pace"},                            Changes::nothing, For::anyone, clock_requests::pace},
    {"pause",           {},                                  Changes::nothing, For::anyone, clock_requests::pause},
    {"ping",            {"count", "deadline_ms", "duration_ms", "interval_us", "priority", "size", "to"},
                                                             Changes::ring,    For::anyone, node_requests::ping},
    {"remove_fault",    {"id"},                              Changes::ring,    For::anyone, remove_fault},
    {"reset",           {"node", "timeout_ms"},              Changes::ring,    For::anyone, node_requests::reset},
    {"run",             {},                                  Changes::nothing, For::anyone, clock_requests::run},
    {"setup",           {},                                  Changes::nothing, For::anyone, node_requests::setup},
    {"shutdown",        {},                                  Changes::nothing, For::anyone, node_requests::shutdown},
    {"status",          {"heard"},                           Changes::nothing, For::anyone, node_requests::status},
    {"step",            {"time_ns"},                         Changes::nothing, For::anyone, clock_requests::step},
    {"stop",            {"node"},                            Changes::ring,    For::anyone, node_requests::stop},
    {"stop_latched",    {"latched"},                         Changes::nothing, For::cpu,    node_requests::stop_latched},
    {"sync",            {},                                  Changes::ring,    For::anyone, node_requests::sync},
    {"warn",            {"text"},                            Changes::nothing, For::cpu,    node_requests::warn},
    {"went_on_without", {"whom"},                            Changes::nothing, For::anyone, clock_requests::went_on_without}};
// clang-format on

std::string names() {
  std::vector<std::string> names;
  for (const RequestKind& kind : kRequests) names.push_back(kind.name);
  return config::join(names);
}

/// The one that `request` is, with members that it takes. @throw RequestError
const RequestKind& kind_of(const Json& request, bool of_cpu) {
  if (!request.contains("do") || !request["do"].is_string()) throw RequestError(kRequestRule);
  const RequestKind* kind = find_request_kind(request);
  if (kind == nullptr)
    throw RequestError("no request '" + request["do"].get<std::string>() + "'; there are " + names());
  require_known_members(request, *kind);
  if (kind->whom == For::cpu && !of_cpu) throw RequestError("only the node's CPU may say " + kind->name);
  return *kind;
}

}  // namespace

void Requests::handle(const std::string& text, bool of_cpu, const Answer& answer) {
  try {
    const Json request = object_in(text, kRequestRule);
    const RequestKind& kind = kind_of(request, of_cpu);
    const Answer while_here = [answer, here = std::weak_ptr<void>(here_)](const Json& reply) {
      if (!here.expired()) answer(reply);
    };
    if (answer_clock_request(to_.virtual_clock, kind, request, while_here)) return;
    if (const auto* of_faults = std::get_if<RequestKind::OfFaults>(&kind.handler))
      (*of_faults)(to_.faults, request, answer);
    else
      std::get<RequestKind::OfNode>(kind.handler)(to_, request, answer);
  } catch (const std::exception& error) {
    answer({{"error", error.what()}});
  }
}

bool Requests::changes_something(const std::string& text) {
  const RequestKind* kind = find_request_kind(Json::parse(text, nullptr, /*allow_exceptions=*/false));
  return kind != nullptr && kind->changes == Changes::ring;
}

const RequestKind* find_request_kind(const nlohmann::json& request) {
  const auto name = request.find("do");
  if (name == request.end() || !name->is_string()) return nullptr;
  const auto found =
      std::find_if(kRequests.begin(), kRequests.end(), [&](const RequestKind& kind) { return *name == kind.name; });
  return found == kRequests.end() ? nullptr : &*found;
}

bool answer_clock_request(ClockControl* clock, const RequestKind& kind, const Json& request, const Answer& answer) {
  const auto* handler = std::get_if<RequestKind::OfClock>(&kind.handler);
  if (handler == nullptr) return false;
  if (clock == nullptr)
    throw RequestError(
        "this ring goes by the machine's clock, which nobody can stop or slow down; 'ringctl up CONFIG "
        "--clock virtual' has one of its own");
  (*handler)(*clock, request, answer);
  return true;
}

void require_known_members(const nlohmann::json& request, const RequestKind& kind) {
  std::vector<std::string> known = kind.members;
  known.emplace_back("do");
  if (const auto unknown = unknown_member(request, known))
    throw RequestError(kind.name + ": '" + *unknown + "' is unknown; " +
                       (kind.members.empty() ? "it takes nothing" : "it takes: " + config::join(kind.members)));
}

}  // namespace limb_ring::runtime
