#include "ros_bridge/ring_listener.h"

#include <poll.h>

#include <algorithm>

#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;

constexpr auto kListenRetry = 100ms;  // a daemon that starts is heard before much happens there
constexpr int kSharesOfOthers = 9;    // one that accepts and says nothing takes a tenth of the time that all have
constexpr auto kAskPeriod = 500ms;
constexpr int kTickMs = 50;            // how soon the end is seen
constexpr int kMessagesOfANode = 256;  // then the other nodes have their turn

}  // namespace

std::vector<const config::NodeConfig*> all_nodes(const config::RingConfig& ring) {
  std::vector<const config::NodeConfig*> nodes;
  for (const auto& node : ring.nodes) nodes.push_back(&node);
  return nodes;
}

RingListener::RingListener(const std::vector<const config::NodeConfig*>& nodes, ConnectOptions daemon,
                           std::string order, OnMessage on_message, AsksAgain asks_again)
    : daemon_(std::move(daemon)),
      order_(std::move(order)),
      on_message_(std::move(on_message)),
      asks_again_(std::move(asks_again)) {
  daemon_.role = Role::tool;
  daemon_.alive_period = 0ms;
  daemon_.timeout = 0ms;
  for (const auto* node : nodes) sources_.emplace_back(node);
  thread_ = std::thread([this] { run(); });
}

RingListener::~RingListener() {
  stopping_ = true;
  thread_.join();
}

bool RingListener::hears(std::uint8_t node) const {
  return std::any_of(sources_.begin(), sources_.end(),
                     [node](const Source& source) { return source.node->id == node && source.is_open; });
}

void RingListener::run() {
  while (!stopping_) {
    bool more = false;
    for (Source& source : sources_) {
      if (!source.port) connect(source);
      if (source.port && asks_again_ && asks_again_(*source.node)) ask(source);
      if (source.port) more |= drain(source);
    }
    if (!more) wait();
  }
}

void RingListener::connect(Source& source) {
  if (Clock::now() < source.next_try) return;
  const auto begun = Clock::now();
  try_to_connect(source);
  const auto ended = Clock::now();
  source.next_try = ended + std::max<Clock::duration>(kListenRetry, kSharesOfOthers * (ended - begun));
}

void RingListener::try_to_connect(Source& source) {
  if (live::is_frozen(ring_directory(daemon_.ring, daemon_.runtime), source.node->id))
    return;  // it would let all others wait, and who wants an end
  try {
    daemon_.node = source.node->name;
    source.port.emplace(HostPort::connect(daemon_));
    source.port->observe(order_);
    source.asked = false;
    source.next_ask = {};
    if (asks_again_) ask(source);
    source.is_open = true;
  } catch (const HostPortError&) {
    // Not there: `ring_status` says so, and this is tried again.
    source.port.reset();
  }
}

void RingListener::ask(Source& source) {
  if (source.asked || Clock::now() < source.next_ask) return;
  source.asked = true;
  source.next_ask = Clock::now() + kAskPeriod;
  source.port->request(R"({"do":"status"})");
}

void RingListener::wait() const {
  std::vector<pollfd> ports;
  for (const Source& source : sources_)
    if (source.port) ports.push_back({source.port->fd(), POLLIN, 0});
  // Interrupted or not: all are read in any case.
  (void)::poll(ports.data(), ports.size(), kTickMs);
}

bool RingListener::drain(Source& source) {
  for (int i = 0; i < kMessagesOfANode; ++i) {
    const auto message = source.port->receive(0ms);
    if (!message) return false;
    if (std::holds_alternative<Reply>(*message)) source.asked = false;
    on_message_(*source.node, *message);
    if (std::holds_alternative<Disconnected>(*message)) {
      source.is_open = false;
      source.port.reset();
      return false;
    }
  }
  return true;
}

}  // namespace limb_ring::bridge
