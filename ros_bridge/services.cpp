#include "ros_bridge/services.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "ring/connect_node.h"
#include "ring/known_stops.h"
#include "ring/reset_node.h"
#include "ring/send_on.h"
#include "ros_bridge/answered.h"
#include "ros_bridge/outcome_word.h"
#include "ros_bridge/service_request.h"

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

}  // namespace limb_ring::bridge
