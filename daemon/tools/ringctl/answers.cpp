#include "tools/ringctl/answers.h"

#include <algorithm>

#include "io/in_parallel.h"
#include "limb_ring/ring_directory.h"
#include "ring/lock_files.h"
#include "tools/ringctl/answer_shape.h"
#include "tools/ringctl/connect_node.h"
#include "tools/ringctl/node_name.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/progress.h"
#include "tools/ringctl/ring_clock.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kAnswerTick{50};

[[noreturn]] void no_answer(const HostPort& port, milliseconds timeout) {
  require_clock_goes(port.ring());
  throw HostPortError("node " + label({port.id(), port.name()}) + " of ring " + port.ring() +
                      " did not answer within " + std::to_string(timeout.count()) + " ms");
}

nlohmann::json checked(const HostPort& port, const std::string& text) {
  const nlohmann::json answer = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!answer.is_object())
    throw HostPortError("node " + label({port.id(), port.name()}) + ": " +
                        sentence_of_shape("it is not a JSON object"));
  if (!answer.contains("error") || !answer["error"].is_string()) return answer;
  const std::string problem = answer["error"].get<std::string>();
  if (!port.connected()) throw gone(port, problem);  // not the daemon's word, but that of the connection to it
  throw NotDone(problem);
}

/// Connecting and the answer together take no longer than an answer may.
Answer ask_one(const std::string& ring, const NodeName& node, const nlohmann::json& request, Deadline all_by) {
  if (live::is_frozen(ring_directory(ring), node.id)) return {};  // it would let us wait
  try {
    const auto begun = steady_clock::now(), deadline = std::min(all_by, begun + kAnswerTime);
    if (deadline <= begun) return {std::nullopt, "it was not asked: no time was left"};
    const auto time = std::chrono::ceil<milliseconds>(deadline - begun);
    HostPort port = connect_within(time, ring, std::to_string(node.id), Stay::asks_only);
    const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now());
    return {checked(port, port.reply(port.request(request.dump()), std::max(left, milliseconds(0)))), ""};
  } catch (const std::exception& problem) {
    return {std::nullopt, problem.what()};
  }
}

}  // namespace

nlohmann::json ask(HostPort& port, const nlohmann::json& request, milliseconds timeout) {
  Progress progress(port.ring());
  return ask(port, request, timeout, [&] { progress.tell("waiting for node " + label({port.id(), port.name()})); });
}

nlohmann::json ask(HostPort& port, const nlohmann::json& request, milliseconds timeout,
                   const std::function<void()>& tick) {
  const auto deadline = steady_clock::now() + timeout;
  const std::uint32_t token = port.request(request.dump());
  while (steady_clock::now() < deadline) {
    const auto message = port.receive(kAnswerTick);
    if (!message)
      tick();
    else if (const auto* reply = std::get_if<Reply>(&*message); reply && reply->token == token)
      return checked(port, reply->json);
    else if (const auto* end = std::get_if<Disconnected>(&*message))
      throw gone(port, end->reason);
  }
  no_answer(port, timeout);
}

std::vector<Answer> ask_all(const std::string& ring, const std::vector<NodeName>& nodes, const nlohmann::json& request,
                            Deadline deadline) {
  std::vector<Answer> answers(nodes.size());
  // A daemon that is stopped takes its whole time-out.
  process::in_parallel(nodes.size(), kAskers,
                       [&](std::size_t i) { answers[i] = ask_one(ring, nodes[i], request, deadline); });
  return answers;
}

}  // namespace limb_ring::ringctl
