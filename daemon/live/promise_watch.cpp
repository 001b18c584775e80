#include "live/promise_watch.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "limb_ring/ring_directory.h"
#include "live/lock_files.h"

namespace limb_ring::live {

using promises::Observation;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

constexpr milliseconds kAnswers{200};  // a daemon that lives
constexpr milliseconds kTriesAgain{250};
/// What a dead daemon has written is all there; one that has closed its door goes on for a moment.
constexpr int kLastRounds = 3;

}  // namespace

PromiseWatch::PromiseWatch(Ring ring, promises::PromiseJudge::OnBreach on_breach)
    : ring_(std::move(ring)),
      folder_(ring_.runtime.empty() ? ring_directory(ring_.name) : ring_.runtime + "/limb_ring/" + ring_.name),
      judge_(ring_.folds_back, std::move(on_breach)) {
  for (const std::uint8_t id : ring_.nodes) nodes_.push_back({id, std::nullopt, nullptr, 0, {}});
}

std::size_t PromiseWatch::watched() const {
  return static_cast<std::size_t>(std::count_if(
      nodes_.begin(), nodes_.end(), [](const Node& node) { return node.port.has_value() && node.reader != nullptr; }));
}

void PromiseWatch::poll() {
  for (Node& node : nodes_) {
    if (node.port) hear(node);
    if (node.reader) read(node);
    if (!node.port && !node.reader) connect(node);
  }
  judge_.round_is_over();
}

void PromiseWatch::finish() {
  for (int i = 0; i <= kLastRounds; ++i) {
    poll();
    std::this_thread::sleep_for(kRound);
  }
}

// One that is stopped would let us wait.
void PromiseWatch::connect(Node& node) {
  if (Clock::now() < node.next_try) return;
  node.next_try = Clock::now() + kTriesAgain;
  const Holder holder = holder_of(folder_, node.id);
  if (!holder.held || holder.frozen) return;
  try {
    ConnectOptions options;
    options.ring = ring_.name;
    options.node = std::to_string(node.id);
    options.timeout = kAnswers;
    options.runtime = ring_.runtime;
    node.port.emplace(HostPort::connect(options));
    node.port->observe(R"({"promises": true})");
    to_date_ = node.port->stamp() - node.port->now();
  } catch (const HostPortError&) {
    node.port.reset();
  }
}

void PromiseWatch::hear(Node& node) {
  while (node.port) {
    const auto message = node.port->receive(milliseconds(0));
    if (!message) {
      if (!node.port->connected()) node.port.reset();
      break;
    }
    if (const auto* seen = std::get_if<Observed>(&*message)) begin(node, seen->json);
    if (std::holds_alternative<Disconnected>(*message)) node.port.reset();
  }
  if (node.port) return;
  node.last_rounds = kLastRounds;
  judge_.closes(node.id);
}

void PromiseWatch::begin(Node& node, const std::string& json) {
  const auto told = nlohmann::json::parse(json, nullptr, /*allow_exceptions=*/false);
  if (told.is_object() && told.contains("error"))
    throw HostPortError("node " + std::to_string(node.id) + ": " + told["error"].get<std::string>());
  if (!told.is_object() || told.value("kind", "") != "promises") return;
  try {
    node.reader = std::make_unique<promises::ObservationReader>(told.at("path").get<std::string>(),
                                                                told.at("from").get<std::uint64_t>());
    judge_.begins(node.id, told.at("state").get<std::uint8_t>(),
                  nanoseconds(told.at("longest_send_ns").get<std::int64_t>()), told.at("at_ns").get<std::int64_t>());
  } catch (const std::exception&) {
    node.port.reset();  // it has ended meanwhile, and is looked for again
  }
}

void PromiseWatch::read(Node& node) {
  const std::uint64_t lost = node.reader->read(seen_);
  if (lost != 0) judge_.lost(node.id, lost);
  for (const Observation& seen : seen_) judge_.see(node.id, seen);
  if (node.port || --node.last_rounds > 0) return;
  judge_.ends(node.id);
  node.reader.reset();
}

}  // namespace limb_ring::live
