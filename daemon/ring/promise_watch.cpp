#include "ring/promise_watch.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "ring/not_done.h"

namespace limb_ring::live {

using promises::Observation;
using std::chrono::milliseconds;
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
