#include "ring/observed_daemon.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"

namespace limb_ring::live {

using std::chrono::milliseconds;

namespace {

constexpr milliseconds kAnswers{200};  // a daemon that lives
constexpr milliseconds kTriesAgain{250};

}  // namespace

ObservedDaemon::ObservedDaemon(const std::string& ring, std::uint8_t node, std::string what, const std::string& runtime)
    : folder_(ring_directory(ring, runtime)), node_(node), what_(std::move(what)) {
  daemon_.ring = ring;
  daemon_.node = std::to_string(node);
  daemon_.runtime = runtime;
  daemon_.timeout = kAnswers;
}

// A frozen daemon is left out: it would keep us waiting.
bool ObservedDaemon::look_for() {
  if (port_ || Clock::now() < next_try_) return connected();
  next_try_ = Clock::now() + kTriesAgain;
  const Holder holder = holder_of(folder_, node_);
  problem_ = holder.problem;
  if (!holder.held || holder.frozen) return false;
  try {
    port_.emplace(HostPort::connect(daemon_));
    port_->observe(what_);
  } catch (const HostPortError& problem) {
    problem_ = problem.what();
    port_.reset();
  }
  return connected();
}

bool ObservedDaemon::may_live() const {
  const Holder holder = holder_of(folder_, node_);
  return holder.held || !holder.problem.empty();
}

std::optional<std::string> ObservedDaemon::next() {
  while (port_) {
    const auto message = port_->receive(milliseconds(0));
    if (!message) {
      if (!port_->connected()) port_.reset();
      return std::nullopt;
    }
    if (const auto* seen = std::get_if<Observed>(&*message)) return seen->json;
    if (std::holds_alternative<Disconnected>(*message)) port_.reset();
  }
  return std::nullopt;
}

HostPort connect_node(const std::string& ring, const std::string& node, Stay stay, std::function<void()> meanwhile) {
  ConnectOptions options;
  options.ring = ring;
  options.node = node;
  options.asks_only = stay == Stay::asks_only;
  options.timeout = std::chrono::milliseconds(0);
  options.meanwhile = std::move(meanwhile);
  return HostPort::connect(options);
}

HostPort connect_ring(const std::string& ring) { return connect_node(ring, std::to_string(kBroadcast)); }

nlohmann::json ask_for_people(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout) {
  return nlohmann::json::parse(port.reply(port.request(request.dump()), timeout));
}

using promises::Observation;
using std::chrono::nanoseconds;

namespace {

/// Rounds in which a daemon's file is still read after its connection has ended: a daemon that closes its host port
/// still writes for a moment. (A dead daemon has written all already.)
constexpr int kLastRounds = 3;
/// At the end: a daemon that has just been started is looked for four times a second.
constexpr int kUntilFound = 20;

}  // namespace

PromiseWatch::PromiseWatch(const Ring& ring, promises::PromiseJudge::OnBreach on_breach)
    : judge_(ring.folds_back, std::move(on_breach)) {
  for (const std::uint8_t id : ring.nodes)
    nodes_.push_back({id, ObservedDaemon(ring.name, id, R"({"promises": true})", ring.runtime)});
}

std::size_t PromiseWatch::watched() const {
  return static_cast<std::size_t>(std::count_if(nodes_.begin(), nodes_.end(), [](const Node& node) {
    return node.daemon.connected() && node.reader != nullptr;
  }));
}

std::vector<PromiseWatch::Unwatched> PromiseWatch::unwatched() const {
  std::vector<Unwatched> all;
  for (const Node& node : nodes_) {
    if (node.daemon.connected() && node.reader != nullptr) continue;
    if (!node.daemon.may_live()) continue;
    const std::string& why = node.problem.empty() ? node.daemon.problem() : node.problem;
    all.push_back({node.id, why.empty() ? "its daemon has not answered" : why});
  }
  return all;
}

void PromiseWatch::poll() {
  for (Node& node : nodes_) {
    if (node.daemon.connected()) hear(node);
    if (node.reader) read(node);
    if (!node.daemon.connected() && !node.reader && node.daemon.look_for()) to_date_ = node.daemon.to_date();
  }
  judge_.round_is_over();
}

void PromiseWatch::finish() {
  for (int i = 0; i <= kLastRounds || (i <= kUntilFound && !unwatched().empty()); ++i) {
    poll();
    std::this_thread::sleep_for(kRound);
  }
}

void PromiseWatch::hear(Node& node) {
  while (const auto seen = node.daemon.next()) begin(node, *seen);
  if (node.daemon.connected()) return;
  node.last_rounds = kLastRounds;
  judge_.closes(node.id);
}

void PromiseWatch::begin(Node& node, const std::string& message) {
  const auto told = nlohmann::json::parse(message, nullptr, /*allow_exceptions=*/false);
  if (told.is_object() && told.contains("error"))
    throw NotDone("node " + std::to_string(node.id) + ": " + told["error"].get<std::string>());
  if (!told.is_object() || told.value("kind", "") != "promises") return;
  try {
    if (node.reader)  // it was removed or cut off, and made again
      return node.reader->follow(told.at("path").get<std::string>(), told.at("from").get<std::uint64_t>());
    node.reader = std::make_unique<promises::ObservationReader>(told.at("path").get<std::string>(),
                                                                told.at("from").get<std::uint64_t>());
    node.problem.clear();
    judge_.begins(node.id, told.at("state").get<std::uint8_t>(),
                  nanoseconds(told.at("longest_send_ns").get<std::int64_t>()), told.at("at_ns").get<std::int64_t>());
  } catch (const std::exception& problem) {
    node.problem = problem.what();
    node.daemon.drop();  // it has ended meanwhile, and is looked for again
  }
}

void PromiseWatch::read(Node& node) {
  const std::uint64_t lost = node.reader->read(seen_);
  if (lost != 0) judge_.lost(node.id, lost);
  for (const Observation& seen : seen_) judge_.see(node.id, seen);
  if (node.daemon.connected() || --node.last_rounds > 0) return;
  judge_.ends(node.id);
  node.reader.reset();
}

}  // namespace limb_ring::live
