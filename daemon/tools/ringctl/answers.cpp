#include "tools/ringctl/answers.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"

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
                        ask::sentence_of_shape("it is not a JSON object"));
  if (!answer.contains("error") || !answer["error"].is_string()) return answer;
  const std::string problem = answer["error"].get<std::string>();
  if (!port.connected()) throw gone(port, problem);  // not the daemon's word, but that of the connection to it
  throw NotDone(problem);
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

std::vector<ask::Answer> ask_all(const std::string& ring, const std::vector<NodeName>& nodes,
                                 const nlohmann::json& request, Deadline deadline) {
  return ask::RingClient(ring, nodes).ask(request, std::min(deadline, steady_clock::now() + kAnswerTime));
}

std::vector<ask::ToldRow> ask_for_rows(const std::string& ring, const std::vector<NodeName>& nodes, Deadline deadline) {
  return ask::RingClient(ring, nodes).status(std::min(deadline, steady_clock::now() + kAnswerTime));
}

}  // namespace limb_ring::ringctl
