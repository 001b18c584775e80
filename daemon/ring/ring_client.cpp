#include "ring/ring_client.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
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

namespace {

constexpr int kLately = 1000;  ///< ms; an older beacon tells nothing

}  // namespace

Rows status_rows(const std::string& ring, const std::vector<Node>& nodes, std::chrono::milliseconds timeout) {
  Rows rows;
  for (ToldRow& told : RingClient(ring, nodes).status(std::chrono::steady_clock::now() + timeout))
    if (told.said) rows.emplace(told.said->id, std::move(*told.said));
  return rows;
}

Rows status_rows_here(const std::string& ring, std::chrono::milliseconds timeout) {
  std::vector<Node> nodes;
  for (const live::HeldNode& held : live::held_nodes(ring_directory(ring))) nodes.push_back({held.node, ""});
  return status_rows(ring, nodes, timeout);
}

const status::Heard* lately_heard_in(const status::NodeRow& row, std::uint8_t node) {
  for (const status::Heard& heard : row.heard)
    if (heard.id == node && heard.age_ms < kLately) return &heard;
  return nullptr;
}

const status::Heard* lately_heard(const Rows& rows, std::uint8_t node) {
  const status::Heard* newest = nullptr;
  for (const auto& [id, row] : rows) {
    const status::Heard* heard = lately_heard_in(row, node);
    if (heard != nullptr && (newest == nullptr || heard->age_ms < newest->age_ms)) newest = heard;
  }
  return newest;
}

std::optional<std::uint8_t> who_reaches(const Rows& rows, std::uint8_t target) {
  const auto row = rows.find(target);
  if (row == rows.end()) return std::nullopt;
  // The newest beacon: others may be from before the ring broke.
  const status::Heard* newest = nullptr;
  for (const auto& [id, unused] : rows) {
    const status::Heard* heard = id == target ? nullptr : lately_heard_in(row->second, id);
    if (heard != nullptr && (newest == nullptr || heard->age_ms < newest->age_ms)) newest = heard;
  }
  return newest == nullptr ? std::nullopt : std::optional(newest->id);
}

std::string name_of(const std::vector<Node>& nodes, std::uint8_t id) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const Node& node) { return node.id == id; });
  return found == nodes.end() ? "node " + std::to_string(id) : found->name;
}

const std::vector<ErrorCounter>& error_counters() {
  using Of = ErrorCounter::Of;
  static const std::vector<ErrorCounter> counters{
      {Of::input, "crc_errors", true},
      {Of::input, "malformed_packets", true},
      {Of::input, "stray_slices", false},
      {Of::input, "oversize_packets", true},
      {Of::input, "stalled_packets", true},
      {Of::input, "broken_off_packets", true},
      {Of::input, "input_losses", false},
      {Of::input, "input_malformed", false},
      {Of::input, "input_datagrams_lost", true},  // each held packets, or a part of one
      {Of::input, "input_datagrams_duplicate", false},
      {Of::input, "input_delay_dropped", false},
      {Of::output, "output_losses", false},
      {Of::output, "output_discarded", false},
      {Of::output, "output_datagrams_unsent", false},
      {Of::output, "dropped_no_output", true},
      {Of::node, "ended_lost", true},
      {Of::node, "ended_refused", false},
      {Of::node, "timeouts", true},
      {Of::node, "returns_damaged", true},
      {Of::node, "returns_unmatched", false},
      {Of::node, "refused_no_buffer", false},
      {Of::node, "insertion_buffer_full", true},
      {Of::node, "interrupt_buffer_full", true},
      {Of::node, "flushed_on_reset", false},
      {Of::node, "orphans_hop", false},
      {Of::node, "duplicate_id_signs", false},
      {Of::node, "host_slow_clients", false},
      {Of::node, "host_interrupts_lost", false},
  };
  return counters;
}

namespace {

/// Nodes learn the ring's size by the HOP of their own packets. For a moment it may be that of before.
std::string other_size(const std::vector<NodeInRing>& nodes, std::size_t up) {
  if (up != nodes.size()) return "";
  for (const NodeInRing& node : nodes)
    if (node.ring_size != 0 && node.ring_size != up)
      return ", but by HOP the ring has " + std::to_string(node.ring_size);
  return "";
}

}  // namespace

std::string ring_in_words(const std::vector<NodeInRing>& nodes, const std::string& broken_line) {
  std::size_t up = 0, folded = 0, open = 0, part = nodes.size();
  for (const NodeInRing& node : nodes) {
    open += node.state == "open_chain" ? 1 : 0;
    up += node.state == "up" || node.state == "folded" ? 1 : 0;
    if (node.state != "folded") continue;
    ++folded;
    if (node.ring_size != 0) part = std::min(part, node.ring_size);
  }
  const std::string working = std::to_string(up + open) + " of " + std::to_string(nodes.size()) + " nodes ";
  if (open != 0) return working + "work, open chain" + (broken_line.empty() ? "" : ": line " + broken_line + " broken");
  if (folded == 0) return working + "up" + other_size(nodes, up);
  // Of two breaks each part is a ring of its own.
  return working + (part < up ? "up, folded back in parts" : "up, folded back around a break");
}

std::string way_to_first_of_chain(const std::string& node) {
  return "mend the line, or let its daemon restart its CPU: 'ringctl fault reset " + node + "'";
}

}  // namespace limb_ring::ask
