#include "tools/ringctl/live_nodes.h"

#include <poll.h>
#include <sys/wait.h>

#include <algorithm>
#include <utility>

#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

using nlohmann::json;
using std::chrono::milliseconds;

namespace {

constexpr milliseconds kGrace{3000};
constexpr milliseconds kNodesTick{20};    ///< signals are looked at so often
constexpr milliseconds kPatience{10000};  ///< with a daemon that runs; machines are busy

/// Waits until the process has stopped or ended (`state`: flags of waitid()). Its exit status is left for reap().
void wait_until(const live::LaunchedRing& daemons, int state) {
  siginfo_t info{};
  ::waitid(P_PID, static_cast<id_t>(daemons.all()[0].program.pid()), &info, state | WEXITED | WNOWAIT);
}

}  // namespace

// ---- processes ------------------------------------------------------------------------------

LiveNodes::~LiveNodes() {
  for (const int number : {SIGTERM, SIGCONT})  // all at once, so that they need not wait for each other
    for (const Node& node : nodes_)
      if (node.daemons) node.daemons->signal(number);
  for (Node& node : nodes_)
    if (node.daemons) node.daemons->end([this](milliseconds time) { return signals_.asked_to_end(time); }, kGrace);
}

void LiveNodes::start(std::size_t place) {
  if (nodes_[place].daemons) return;
  RingPlan one = plan_;
  one.nodes = {plan_.nodes[place]};
  nodes_[place].daemons = std::make_unique<live::LaunchedRing>(launch_request(one, process::Lifetime::killed));
}

void LiveNodes::kill(std::size_t place) {
  Node& node = nodes_[place];
  if (!node.daemons) return;
  node.daemons->signal(SIGKILL);
  wait_until(*node.daemons, WEXITED);
  node.daemons->reap();
  if (node.port) take_messages();  // what it said before it died
  node = Node{};
  const auto is_its = [place](const Asked& asked) { return asked.place == place; };
  outstanding_.erase(std::remove_if(outstanding_.begin(), outstanding_.end(), is_its), outstanding_.end());
}

void LiveNodes::freeze(std::size_t place) {
  Node& node = nodes_[place];
  if (!running(place)) return;
  node.daemons->signal(SIGSTOP);
  wait_until(*node.daemons, WSTOPPED);
  node.frozen = true;
  node.row.reset();
  node.asked.reset();
}

void LiveNodes::thaw(std::size_t place) {
  if (!nodes_[place].frozen) return;
  nodes_[place].frozen = false;
  nodes_[place].daemons->signal(SIGCONT);
}

std::optional<std::string> LiveNodes::exit_reason() {
  for (Node& node : nodes_) {
    if (!node.daemons) continue;
    node.daemons->reap();
    const live::LaunchedDaemon* dead = node.daemons->first_ended();
    if (dead == nullptr) continue;
    if (signals_.asked_to_end(milliseconds(0))) throw Interrupted();  // which may have ended it, too
    return dead->exit_reason();
  }
  return std::nullopt;
}

std::string LiveNodes::last_lines(std::size_t place) const {
  return nodes_[place].daemons ? nodes_[place].daemons->all()[0].last_lines() : "";
}

// ---- messages -------------------------------------------------------------------------------

void LiveNodes::connect(std::size_t place) {
  Node& node = nodes_[place];
  try {
    node.port.emplace(connect_node(plan_.ring, std::to_string(plan_.nodes[place].id), Stay::for_long));
    node.port->observe(json{{"kinds", {"pin"}}}.dump());
    for (const json& what : std::exchange(node.pending, {})) request(place, what);
  } catch (const HostPortError&) {
    node.port.reset();  // not there yet: the next poll() tries again
  }
}

/// @return whether the answer of a running node is still missing
bool LiveNodes::ask_for_rows() {
  for (std::size_t place = 0; place < nodes_.size(); ++place) {
    Node& node = nodes_[place];
    if (!node.port && running(place)) connect(place);
    if (!running(place) || !node.port)
      node.row.reset();
    else
      node.asked = node.port->request(json{{"do", "status"}}.dump());
  }
  return std::any_of(nodes_.begin(), nodes_.end(), [](const Node& node) { return node.asked.has_value(); });
}

std::string LiveNodes::poll() {
  if (!ask_for_rows()) return "";
  const auto all_have = [this] {
    return std::none_of(nodes_.begin(), nodes_.end(), [](const Node& node) { return node.asked.has_value(); });
  };
  const bool complete = pump(Clock::now() + kPatience, all_have);
  for (std::size_t place = 0; !complete && place < nodes_.size(); ++place)
    if (nodes_[place].asked) return "node " + name(place) + " does not answer" + last_lines(place);
  return request_error_;
}

bool LiveNodes::pump(Clock::time_point until, const std::function<bool()>& done) {
  for (;;) {
    if (signals_.asked_to_end(milliseconds(0))) throw Interrupted();
    take_messages();
    const Clock::time_point next = on_turn();
    if (done()) return true;
    const auto now = Clock::now();
    if (now >= until) return false;
    wait_for_messages(std::min({until, next, now + kNodesTick}));
  }
}

void LiveNodes::wait_for_messages(Clock::time_point until) {
  std::vector<pollfd> doors;
  for (const Node& node : nodes_)
    if (node.port) doors.push_back({node.port->fd(), POLLIN, 0});
  const auto wait = std::chrono::ceil<milliseconds>(std::max(until - Clock::now(), Clock::duration::zero()));
  ::poll(doors.data(), doors.size(), static_cast<int>(wait.count()));
}

void LiveNodes::take_messages() {
  for (std::size_t place = 0; place < nodes_.size(); ++place)
    while (nodes_[place].port) {
      const auto message = nodes_[place].port->receive(milliseconds(0));
      if (!message) break;
      take(place, *message);
    }
}

void LiveNodes::take(std::size_t place, const Message& message) {
  Node& node = nodes_[place];
  if (std::holds_alternative<Disconnected>(message)) {
    node.port.reset();
    node.asked.reset();
    return;
  }
  const auto* reply = std::get_if<Reply>(&message);
  if (!reply) return on_message(place, message);
  if (node.asked == reply->token) {
    const std::string wrong = status::read(json::parse(reply->json), node.row.emplace());
    if (!wrong.empty()) request_error_ = "node " + name(place) + ": " + ask::sentence_of_shape(wrong);
    node.asked.reset();
  } else {
    answered(place, *reply);
  }
}

// An answer that belongs to no request comes from a node that was frozen meanwhile: nobody waits for it any more.
void LiveNodes::answered(std::size_t place, const Reply& reply) {
  const auto is = [&](const Asked& asked) { return asked.place == place && asked.token == reply.token; };
  const json answer = json::parse(reply.json);
  if (asked_ && is(*asked_)) asked_->answer = answer;
  const auto request = std::find_if(outstanding_.begin(), outstanding_.end(), is);
  if (request == outstanding_.end()) return;
  outstanding_.erase(request);
  if (answer.contains("error")) request_error_ = answer["error"].get<std::string>();
}

LiveNodes::Asked LiveNodes::send(std::size_t place, const json& request) {
  if (!port(place)) throw NotDone("node " + name(place) + " is not there: " + request.dump());
  return {place, port(place)->request(request.dump()), std::nullopt};
}

void LiveNodes::request(std::size_t place, const json& what) {
  if (port(place))
    outstanding_.push_back(send(place, what));
  else
    nodes_[place].pending.push_back(what);
}

json LiveNodes::ask(std::size_t place, const json& what) {
  asked_ = send(place, what);
  if (!pump(Clock::now() + kPatience, [this] { return asked_->answer.has_value(); }))
    throw NotDone("node " + name(place) + " did not answer: " + what.dump());
  const json answer = *std::exchange(asked_, std::nullopt)->answer;
  if (answer.contains("error")) throw NotDone(answer["error"].get<std::string>());
  return answer;
}

}  // namespace limb_ring::ringctl
