#include "ros_bridge/services.h"

#include <cmath>
#include <future>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "ask/known_stops.h"
#include "ask/reset_node.h"
#include "config/characters.h"
#include "config/quantity.h"
#include "ros_bridge/answered.h"
#include "ros_bridge/outcome_word.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using std::chrono::milliseconds;

constexpr int kStopThreads = 2, kThreads = 3;
constexpr auto kServiceConnect = 1s;
constexpr auto kServiceAnswer = 10s;  // a send ends after timeouts.queue and its tries
constexpr auto kReset = 3s;
constexpr double kShortestTimeout = 1e-3, kLongestTimeout = 60.0;  // s, of a time-out

std::string known_nodes(const config::RingConfig& ring) {
  std::string names;
  for (const auto& node : ring.nodes)
    names += (names.empty() ? "" : ", ") + node.name + " (" + std::to_string(node.id) + ")";
  return names;
}

double in_seconds(std::chrono::nanoseconds time) { return std::chrono::duration<double>(time).count(); }

/// The time-out that was asked for; 0: the usual one. Very short ones are refused: rosservice reads a whole number as
/// nanoseconds, which nobody means here. @throw std::invalid_argument
milliseconds timeout_of(const ros::Duration& asked, std::chrono::seconds usual) {
  if (asked.isZero()) return usual;
  if (asked.toSec() < kShortestTimeout || asked.toSec() > kLongestTimeout)
    throw std::invalid_argument("timeout of " + config::format_time(std::chrono::nanoseconds(asked.toNSec())) +
                                "; it must be 0 (for " + std::to_string(usual.count()) +
                                " s), or 1 ms to 60 s: to rosservice 2 s are {secs: 2}");
  return milliseconds(std::lround(asked.toSec() * 1000));
}

json answer_to(HostPort& port, const json& question, milliseconds timeout) {
  return json::parse(port.ask(question.dump(), timeout));
}

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

}  // namespace

Services::Services(const ros::NodeHandle& nodes, const config::RingConfig& ring, ConnectOptions daemon, RingPort& port,
                   CommandIn& commands)
    : ring_(ring),
      daemon_(std::move(daemon)),
      port_(port),
      commands_(commands),
      stop_calls_(nodes, kStopThreads),
      other_calls_(nodes, kThreads) {
  daemon_.role = Role::tool;
  daemon_.alive_period = 0ms;
  daemon_.timeout = kServiceConnect;
  stop_calls_.names().advertise("stop", &Services::stop, this);
  other_calls_.names().advertise("reset_node", &Services::reset_node, this);
  other_calls_.names().advertise("send_interrupt", &Services::send_interrupt, this);
  other_calls_.names().advertise("resume", &Services::resume, this);
  faults_.emplace(other_calls_.names(), ring_, daemon_.node, port_);
  stop_calls_.start();
  other_calls_.start();
}

Services::~Services() {
  stop_calls_.stop();
  other_calls_.stop();
}

std::uint8_t Services::one_node(const std::string& node) const {
  if (const auto* found = ring_.find(node)) return found->id;
  throw std::invalid_argument("no node '" + config::printable(node) + "' in ring " + ring_.ring +
                              "; there are: " + known_nodes(ring_));
}

std::uint8_t Services::destination(const std::string& node) const {
  return node == "all" ? kBroadcast : one_node(node);
}

bool Services::reset_node(ResetNode::Request& request, ResetNode::Response& response) {
  return answered(port_, response, [&] {
    const auto id = one_node(request.node);
    const auto timeout = timeout_of(request.timeout, kReset);
    const std::uint8_t own = HostPort::connect(daemon_).id();
    if (id == own) throw would_reset_bridge(request.node, "ringctl reset");
    const auto reply = ask::reset_node({ring_.ring, nodes_to_ask(), id, own, true, timeout});
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
    const auto to = destination(request.node);
    const auto timeout = timeout_of(request.timeout, kServiceAnswer);
    auto port = HostPort::connect(daemon_);
    if (to == port.id() && ring_.find(to)->pins[request.factor].action == config::PinConfig::Action::reset)
      throw would_reset_bridge(request.node, "ringctl interrupt");
    const auto result = port.wait(port.interrupt(to, request.factor, request.force), timeout);
    fill(response, to_string(result.outcome), in_seconds(result.round_trip), result.reason);
  });
}

bool Services::stop(Stop::Request& request, Stop::Response& response) {
  return answered(port_, response, [&] {
    const auto timeout = timeout_of(request.timeout, kServiceAnswer);
    json ask_stop = {{"do", "stop"}};
    if (!request.node.empty() && request.node != "all") ask_stop["node"] = std::to_string(one_node(request.node));
    auto port = HostPort::connect(daemon_);
    const auto sent = std::chrono::steady_clock::now();
    const auto reply = answer_to(port, ask_stop, timeout);
    fill(response, reply.value("outcome", "unknown"), reply.value("round_trip_us", 0.0) * 1e-6,
         reply.value("reason", ""));
    const auto stops = ask::wait_for_stops(ring_.ring, nodes_to_ask(request.node), sent,
                                           reply.value("outcome", "") == to_string(Outcome::delivered));
    response.message += (response.message.empty() ? "" : "; ") + sentence_of(stops);
  });
}

std::vector<ask::Node> Services::nodes_to_ask(const std::string& which) const {
  std::vector<ask::Node> nodes;
  for (const auto& node : ring_.nodes)
    if (which.empty() || which == "all" || one_node(which) == node.id) nodes.push_back({node.id, node.name});
  return nodes;
}

std::vector<std::uint8_t> Services::nodes_to_resume(std::uint8_t destination) const {
  std::set<std::uint8_t> latched;
  for (const ask::Node& node : ask::nodes_with_latched_stop(ring_.ring, nodes_to_ask())) latched.insert(node.id);
  std::vector<std::uint8_t> ids;
  for (const auto& node : ring_.nodes) {
    const bool can_be = !node.joints.empty() || latched.count(node.id) != 0;
    if (can_be && (destination == kBroadcast || destination == node.id)) ids.push_back(node.id);
  }
  return ids;
}

Result Services::resume_one(std::uint8_t node, std::chrono::steady_clock::time_point deadline) {
  const auto done = std::make_shared<std::promise<Result>>();
  auto result = done->get_future();
  const bool asked = commands_.resume(node, [done](const Result& r) { done->set_value(r); });
  if (!asked || result.wait_until(deadline) != std::future_status::ready)
    throw std::runtime_error("node " + std::to_string(node) + ": no result in time");
  return result.get();
}

bool Services::resume(Resume::Request& request, Resume::Response& response) {
  return answered(port_, response, [&] {
    const auto deadline = std::chrono::steady_clock::now() + timeout_of(request.timeout, kServiceAnswer);
    const auto ids = nodes_to_resume(request.node.empty() ? kBroadcast : destination(request.node));
    if (ids.empty())
      throw std::invalid_argument("node '" + request.node + "' has no joints, and no stop is latched there");
    const auto add = [&response](const std::string& problem) {
      response.success = false;
      response.message += problem + "; ";
    };
    std::vector<ask::Node> taken;
    for (const auto id : ids) {
      const auto result = resume_one(id, deadline);
      if (result.outcome == Outcome::delivered)
        taken.push_back({id, ring_.find(id)->name});
      else
        add("node " + std::to_string(id) + ": the resume ended '" + to_string(result.outcome) + "'" +
            (result.reason.empty() ? "" : ", " + result.reason));
    }
    for (const ask::Node& node : ask::wait_for_resumes(ring_.ring, taken)) add(ask::sentence_of_latched(node));
  });
}

}  // namespace limb_ring::bridge
