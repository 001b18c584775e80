#include "ring/observed_daemon.h"

#include <utility>

#include "limb_ring/ring_directory.h"
#include "ring/lock_files.h"

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

}  // namespace limb_ring::live
