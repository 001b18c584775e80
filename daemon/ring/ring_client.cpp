#include "ring/ring_client.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "io/in_parallel.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"

namespace limb_ring::ask {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// How many are connected to at the same time: all of a ring, as one that is silent takes all of the time.
constexpr std::size_t kAskers = 256;

std::string no_answer_within(steady_clock::duration time) {
  return "its daemon did not answer within " + std::to_string(std::chrono::ceil<milliseconds>(time).count()) + " ms";
}

Answer answer_in(const std::string& text) {
  json answer = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!answer.is_object()) return {std::nullopt, sentence_of_shape("it is not an object"), true};
  const auto error = answer.find("error");
  if (error != answer.end() && error->is_string()) return {std::nullopt, error->get<std::string>()};
  return {std::move(answer), ""};
}

}  // namespace

RingClient::RingClient(const std::string& ring, std::vector<Node> nodes, live::Stay stay, const std::string& runtime)
    : folder_(ring_directory(ring, runtime)) {
  options_.ring = ring;
  options_.runtime = runtime;
  options_.asks_only = stay == live::Stay::asks_only;
  options_.timeout = milliseconds(0);
  for (Node& node : nodes) daemons_.push_back({std::move(node), std::nullopt, {}, std::nullopt});
}

HostPort* RingClient::port(std::size_t node) {
  auto& port = daemons_[node].port;
  return port && port->connected() ? &*port : nullptr;
}

void RingClient::connect(std::size_t node, Deadline deadline) {
  const auto begun = steady_clock::now();
  ConnectOptions options = options_;
  options.node = std::to_string(daemons_[node].node.id);
  options.meanwhile = [begun, deadline] {
    if (steady_clock::now() >= deadline) throw HostPortTimeout(no_answer_within(deadline - begun));
  };
  daemons_[node].port.emplace(HostPort::connect(options));
  on_connect(node, *daemons_[node].port);
}

Answer RingClient::begin(std::size_t node, const std::string& request, Deadline deadline) {
  Daemon& daemon = daemons_[node];
  const auto now = steady_clock::now();
  daemon.token.reset();
  if (now >= deadline) return {std::nullopt, "it was not asked: no time was left"};
  if (live::is_frozen(folder_, daemon.node.id)) return {};  // it would let us wait
  if (now < daemon.next_try) return {std::nullopt, "it was not there a moment ago"};
  try {
    if (!daemon.port) connect(node, deadline);
    daemon.token = daemon.port->request(request);
    return {};
  } catch (const HostPortError& problem) {
    daemon.port.reset();
    daemon.next_try = now + pause;
    return {std::nullopt, problem.what()};
  }
}

Answer RingClient::end(std::size_t node, Deadline begun, Deadline deadline) {
  Daemon& daemon = daemons_[node];
  while (daemon.port->connected()) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now());
    const auto message = daemon.port->receive(std::max(left, milliseconds(0)));
    const Reply* reply = message ? std::get_if<Reply>(&*message) : nullptr;
    if (reply != nullptr && reply->token == daemon.token) return answer_in(reply->json);
    if (message) on_message(node, *message);
    const bool late = !message || steady_clock::now() >= deadline;  // what is observed may keep coming
    if (!late || !daemon.port->connected()) continue;
    daemon.next_try = steady_clock::now() + pause;
    return {std::nullopt, no_answer_within(deadline - begun)};
  }
  daemon.port.reset();
  return {std::nullopt, "its daemon has closed the connection"};
}

std::vector<Answer> RingClient::ask(const std::vector<std::size_t>& nodes, const std::string& request,
                                    Deadline deadline) {
  const auto begun = steady_clock::now();
  std::vector<Answer> answers(nodes.size());
  std::vector<std::size_t> unconnected;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (daemons_[nodes[i]].port)
      answers[i] = begin(nodes[i], request, deadline);
    else
      unconnected.push_back(i);
  }
  process::in_parallel(unconnected.size(), kAskers, [&](std::size_t i) {
    answers[unconnected[i]] = begin(nodes[unconnected[i]], request, deadline);
  });
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (daemons_[nodes[i]].token) answers[i] = end(nodes[i], begun, deadline);
  return answers;
}

std::vector<Answer> RingClient::ask(const json& request, Deadline deadline) {
  std::vector<std::size_t> all(daemons_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return ask(all, request.dump(), deadline);
}

ToldRow RingClient::row_in(std::size_t node, Answer answer) const {
  if (!answer.said) return {std::nullopt, std::move(answer.why_not), answer.unreadable};
  status::NodeRow row;
  std::string wrong = status::read(*answer.said, row);
  if (wrong.empty() && row.id != daemons_[node].node.id) wrong = "it says that it is node " + std::to_string(row.id);
  if (!wrong.empty()) return {std::nullopt, sentence_of_shape(wrong), true};
  return {std::move(row), ""};
}

std::vector<ToldRow> RingClient::status(Deadline deadline, bool with_heard) {
  std::vector<Answer> answers = ask(json{{"do", "status"}, {"heard", with_heard}}, deadline);
  std::vector<ToldRow> rows;
  for (std::size_t i = 0; i < answers.size(); ++i) rows.push_back(row_in(i, std::move(answers[i])));
  return rows;
}

ToldRow RingClient::status_of(std::size_t node, Deadline deadline) {
  return row_in(node, ask({node}, R"({"do": "status"})", deadline).front());
}

std::string sentence_of_shape(const std::string& wrong) {
  return "unexpected reply from its daemon: " + wrong +
         "; both have to be of one version of limb_ring ('ringctl down' and 'ringctl up' start this one's)";
}

}  // namespace limb_ring::ask
