#include "ros_bridge/services.h"

#include <ros/init.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "config/quantity.h"
#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "ring/known_stops.h"
#include "ring/observed_daemon.h"
#include "ring/reset_node.h"
#include "ros_bridge/conversions.h"
#include "ros_bridge/ring_port.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using std::chrono::milliseconds;

constexpr int kStopThreads = 2, kCommandThreads = 2, kLongThreads = 3;
constexpr auto kServiceConnect = 1s;
constexpr std::chrono::seconds kReset{3};

double in_seconds(std::chrono::nanoseconds time) { return std::chrono::duration<double>(time).count(); }

std::invalid_argument would_reset_bridge(const std::string& node, const std::string& instead) {
  return std::invalid_argument("node '" + node +
                               "' is this bridge's own: it would be killed before it could answer; use " + instead);
}

template <typename Response>
void fill(Response& response, const std::string& outcome, double round_trip, const std::string& message) {
  response.outcome = outcome_word(outcome);
  response.success = response.outcome == "delivered";
  response.round_trip = round_trip;
  response.message = message;
}

void take_result(const json& reply, Stop::Response& response) {
  fill(response, reply.value("outcome", "unknown"), reply.value("round_trip_us", 0.0) * 1e-6,
       reply.value("reason", ""));
}

}  // namespace

Services::Services(const ros::NodeHandle& nodes, const config::RingConfig& ring, ConnectOptions daemon, RingPort& port,
                   CommandIn& commands)
    : ring_(ring),
      daemon_(std::move(daemon)),
      port_(port),
      stop_calls_(nodes, kStopThreads),
      command_calls_(nodes, kCommandThreads),
      long_calls_(nodes, kLongThreads) {
  daemon_.role = Role::tool;
  daemon_.alive_period = 0ms;
  daemon_.timeout = kServiceConnect;
  daemon_.asks_only = true;
  stop_calls_.names().advertise("stop", &Services::stop, this);
  command_calls_.names().advertise("send_interrupt", &Services::send_interrupt, this);
  resume_.emplace(command_calls_.names(), ring_, daemon_, port_, commands);
  long_calls_.names().advertise("reset_node", &Services::reset_node, this);
  faults_.emplace(long_calls_.names(), ring_, daemon_.node, port_);
  for (CallThreads* calls : {&stop_calls_, &command_calls_, &long_calls_}) calls->start();
}

Services::~Services() {
  for (CallThreads* calls : {&stop_calls_, &command_calls_, &long_calls_}) calls->stop();
}

bool Services::reset_node(ResetNode::Request& request, ResetNode::Response& response) {
  return answered(port_, response, [&] {
    const auto id = one_node(ring_, request.node);
    const auto timeout = timeout_of(request.timeout, kReset);
    const std::uint8_t own = HostPort::connect(daemon_).id();
    if (id == own) throw would_reset_bridge(request.node, "ringctl reset");
    const auto reply = ask::reset_node({ring_.ring, nodes_to_ask(ring_), id, own, true, timeout});
    response.success = reply.value("success", false);
    response.message = reply.value("message", "");
    response.round_trip = reply.value("round_trip_us", 0.0) * 1e-6;
    response.boots = reply.value("boots", 0u);
  });
}

bool Services::send_interrupt(SendInterrupt::Request& request, SendInterrupt::Response& response) {
  return answered(port_, response, [&] {
    if (request.factor > 7)
      throw std::invalid_argument("factor " + std::to_string(request.factor) + "; it must be 0 to 7");
    const auto to = destination_of(ring_, request.node);
    const auto timeout = timeout_of(request.timeout);
    auto port = HostPort::connect(daemon_);
    if (to == port.id() && ring_.find(to)->pins[request.factor].action == config::PinConfig::Action::reset)
      throw would_reset_bridge(request.node, "ringctl interrupt");
    const auto result = port.wait(port.interrupt(to, request.factor, request.force), timeout);
    fill(response, to_string(result.outcome), in_seconds(result.round_trip), result.reason);
  });
}

bool Services::stop(Stop::Request& request, Stop::Response& response) {
  return answered(port_, response, [&] {
    const auto timeout = timeout_of(request.timeout);
    const bool all = request.node.empty() || request.node == "all";
    json order = {{"do", "stop"}};
    if (!all) order["node"] = std::to_string(one_node(ring_, request.node));
    ask::SentStop sent{ring_.ring, nodes_to_ask(ring_, request.node), std::chrono::steady_clock::now(), all};
    auto port = HostPort::connect(daemon_);
    take_result(live::ask_for_people(port, order, timeout), response);
    sent.delivered = response.success;
    ask::send_on(sent, port.id(), sent.sent + timeout, [&](std::uint8_t node, milliseconds left) {
      ConnectOptions other = daemon_;
      other.node = std::to_string(node);
      auto other_port = HostPort::connect(other);
      const json reply = live::ask_for_people(other_port, order, left);
      if (!all) take_result(reply, response);
      return reply.value("outcome", "") == to_string(Outcome::delivered);
    });
    response.message += (response.message.empty() ? "" : "; ") + sentence_of(ask::wait_for_stops(sent));
  });
}

namespace {

using fault::Name;

void append(std::string& text, const std::string& more, const char* between) {
  if (!more.empty()) text += (text.empty() ? "" : between) + more;
}

/// A node that is frozen for a time does not stay frozen when the bridge ends.
bool sleeps_until_shutdown(std::chrono::milliseconds time) {
  std::this_thread::sleep_for(time);
  return ros::isShuttingDown();
}

}  // namespace

FaultServices::FaultServices(TwoNames& names, const config::RingConfig& ring, const std::string& own, RingPort& port)
    : ring_nodes_(fault::nodes_by_id(ring)), own_(own), port_(port), faults_(ring.ring, ring_nodes_) {
  names.advertise("inject_fault", &FaultServices::inject, this);
  names.advertise("clear_faults", &FaultServices::clear, this);
  names.advertise("list_faults", &FaultServices::list, this);
}

void FaultServices::require_survival(const fault::Fault& fault) const {
  if (fault.name != Name::hang && fault.name != Name::crash && fault.name != Name::reset) return;
  for (const auto& node : ring_nodes_) {
    const bool hit = std::count(fault.nodes.begin(), fault.nodes.end(), node.id) != 0;
    if (hit && (own_ == node.name || own_ == node.number))
      throw std::invalid_argument("the CPU of node " + node.name +
                                  " is this bridge, which could not answer then; use "
                                  "ringctl fault");
  }
}

bool FaultServices::inject(InjectFault::Request& request, InjectFault::Response& response) {
  return answered(port_, response, [&] {
    const fault::Fault fault = fault::from_words(request.fault, ring_nodes_);
    require_survival(fault);
    for (const live::Begun& begun : faults_.begin(fault, sleeps_until_shutdown)) {
      append(response.message, begun.words, "; ");
      append(response.id, begun.id, " ");
    }
  });
}

bool FaultServices::clear(ClearFaults::Request& request, ClearFaults::Response& response) {
  return answered(port_, response, [&] {
    if (!request.id.empty()) return faults_.remove(request.id);
    for (const std::string& problem : faults_.clear()) append(response.message, problem, "; ");
    response.success = response.message.empty();
  });
}

bool FaultServices::list(ListFaults::Request&, ListFaults::Response& response) {
  return answered(port_, response, [&] {
    const live::FaultList list = faults_.list();
    for (const std::string& problem : list.unknown) append(response.message, problem, "; ");
    response.success = list.unknown.empty();
    for (const status::Fault& fault : list.faults) {
      response.ids.push_back(fault.id.text);
      response.faults.push_back(fault.fault);
      response.ages.push_back(fault.age_s);
      response.hits.push_back(fault.hits);
    }
  });
}

namespace {

milliseconds until(std::chrono::steady_clock::time_point deadline) {
  return std::max(milliseconds(0),
                  std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now()));
}

/// One that has not come by then counts as lost: it may still have its effect.
Result result_by(std::chrono::steady_clock::time_point deadline, std::future<Result>& result) {
  if (result.wait_until(deadline) == std::future_status::ready) return result.get();
  Result none;
  none.outcome = Outcome::lost;
  none.reason = "no result in time";
  return none;
}

/// Why a node is not known to have resumed; empty: it has.
std::string problem_of(const ask::Resumed& resumed) {
  const Result& result = resumed.result;
  if (resumed.done()) return "";
  if (resumed.is_latched && result.outcome == Outcome::delivered) return ask::sentence_of_latched(resumed.node);
  return resumed.node.name + ": the resume ended '" + to_string(result.outcome) + "'" +
         (result.reason.empty() ? "" : ", " + result.reason);
}

void tell(const std::vector<ask::Resumed>& nodes, Resume::Response& response) {
  std::vector<std::string> said, resumed;
  for (const auto& one : nodes) {
    if (const std::string problem = problem_of(one); !problem.empty())
      said.push_back(problem);
    else
      resumed.push_back(one.node.name);
  }
  response.success = said.empty();
  if (!resumed.empty()) said.push_back("resumed: " + config::join(resumed, ", "));
  response.message = config::join(said, "; ");
}

}  // namespace

ResumeService::ResumeService(TwoNames& names, const config::RingConfig& ring, ConnectOptions daemon, RingPort& port,
                             CommandIn& commands)
    : ring_(ring), daemon_(std::move(daemon)), port_(port), commands_(commands) {
  names.advertise("resume", &ResumeService::resume, this);
}

std::vector<ask::Resumed> ResumeService::nodes_to_resume(std::uint8_t destination) const {
  const auto latched = ask::nodes_with_latched_stop(ring_.ring, nodes_to_ask(ring_));
  std::vector<ask::Resumed> nodes;
  for (const auto& node : ring_.nodes) {
    const bool was_latched = ask::is_among(latched, node.id), can_be = !node.joints.empty() || was_latched;
    if (can_be && (destination == kBroadcast || destination == node.id))
      nodes.push_back({{node.id, node.name}, {}, was_latched});
  }
  return nodes;
}

Result ResumeService::resume_from(std::uint8_t sender, std::uint8_t node, milliseconds timeout) const {
  ConnectOptions nearer = daemon_;
  nearer.node = std::to_string(sender);
  auto port = HostPort::connect(nearer);
  return ask::resume_cpu(port, node, timeout);
}

std::future<Result> ResumeService::resume_from_bridge(std::uint8_t node) {
  const auto done = std::make_shared<std::promise<Result>>();
  auto result = done->get_future();
  if (commands_.resume(node, [done](const Result& ended) { done->set_value(ended); })) return result;
  Result busy;
  busy.outcome = Outcome::cancelled;
  busy.reason = "the bridge has too much to do";
  done->set_value(busy);
  return result;
}

// All are asked before the first one is waited for: the others do not pay for one that does not answer.
bool ResumeService::resume(Resume::Request& request, Resume::Response& response) {
  return answered(port_, response, [&] {
    const auto deadline = std::chrono::steady_clock::now() + timeout_of(request.timeout);
    const auto to = request.node.empty() ? kBroadcast : destination_of(ring_, request.node);
    auto nodes = nodes_to_resume(to);
    if (nodes.empty())
      throw std::invalid_argument(to == kBroadcast ? "no node has joints, and none is stopped"
                                                   : "node '" + request.node + "' has no joints, and is not stopped");
    std::vector<std::future<Result>> results;
    for (const auto& one : nodes) results.push_back(resume_from_bridge(one.node.id));
    for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].result = result_by(deadline, results[i]);
    for (auto& one : nodes)
      one.result = ask::resume_from_nearer(ring_.ring, one.node.id, one.result, [&](std::uint8_t sender) {
        return resume_from(sender, one.node.id, until(deadline));
      });
    ask::look_at(ring_.ring, nodes_to_ask(ring_), nodes);
    tell(nodes, response);
  });
}

namespace {

constexpr double kShortestTimeout = 1e-3, kLongestTimeout = 60.0;  // s

std::string known_nodes(const config::RingConfig& ring) {
  std::string names;
  for (const auto& node : ring.nodes)
    names += (names.empty() ? "" : ", ") + node.name + " (" + std::to_string(node.id) + ")";
  return names;
}

}  // namespace

std::chrono::milliseconds timeout_of(const ros::Duration& asked, std::chrono::seconds usual) {
  if (asked.isZero()) return usual;
  if (asked.toSec() < kShortestTimeout || asked.toSec() > kLongestTimeout)
    throw std::invalid_argument("timeout of " + config::format_time(std::chrono::nanoseconds(asked.toNSec())) +
                                "; it must be 0 (for " + std::to_string(usual.count()) +
                                " s), or 1 ms to 60 s: to rosservice 2 s are {secs: 2}");
  return std::chrono::milliseconds(std::lround(asked.toSec() * 1000));
}

std::uint8_t one_node(const config::RingConfig& ring, const std::string& node) {
  if (const auto* found = ring.find(node)) return found->id;
  throw std::invalid_argument("no node '" + config::printable(node) + "' in ring " + ring.ring +
                              "; there are: " + known_nodes(ring));
}

std::uint8_t destination_of(const config::RingConfig& ring, const std::string& node) {
  return node == "all" ? kBroadcast : one_node(ring, node);
}

std::vector<ask::Node> nodes_to_ask(const config::RingConfig& ring, const std::string& which) {
  const bool all = which.empty() || which == "all";
  const std::uint8_t only = all ? kBroadcast : one_node(ring, which);
  std::vector<ask::Node> nodes;
  for (const auto& node : ring.nodes)
    if (all || node.id == only) nodes.push_back({node.id, node.name});
  return nodes;
}

}  // namespace limb_ring::bridge
