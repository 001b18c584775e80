#include "ros_bridge/resume_service.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "config/names.h"
#include "ring/known_stops.h"
#include "ring/resume_cpu.h"
#include "ros_bridge/answered.h"
#include "ros_bridge/service_request.h"

namespace limb_ring::bridge {
namespace {

using std::chrono::milliseconds;

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
      throw std::invalid_argument(to == kBroadcast
                                      ? "no node has joints, and no stop is latched"
                                      : "node '" + request.node + "' has no joints, and no stop is latched there");
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

}  // namespace limb_ring::bridge
