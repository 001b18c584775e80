#include "ros_bridge/ring_listener.h"

#include <poll.h>

#include <algorithm>

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;

constexpr auto kListenRetry = 100ms;   // a daemon that starts is heard before much happens there
constexpr int kTickMs = 50;            // how soon the end is seen
constexpr int kMessagesOfANode = 256;  // then the other nodes have their turn

}  // namespace

RingListener::RingListener(const std::vector<const config::NodeConfig*>& nodes, ConnectOptions door, std::string order,
                           OnMessage on_message)
    : door_(std::move(door)), order_(std::move(order)), on_message_(std::move(on_message)) {
  door_.role = Role::tool;
  door_.alive_period = 0ms;
  door_.timeout = 0ms;
  for (const auto* node : nodes) ears_.emplace_back(node);
  thread_ = std::thread([this] { run(); });
}

RingListener::~RingListener() {
  stopping_ = true;
  thread_.join();
}

bool RingListener::hears(std::uint8_t node) const {
  return std::any_of(ears_.begin(), ears_.end(),
                     [node](const Ear& ear) { return ear.node->id == node && ear.is_open; });
}

void RingListener::run() {
  while (!stopping_) {
    bool more = false;
    for (Ear& ear : ears_) {
      if (!ear.port) connect(ear);
      if (ear.port) more |= drain(ear);
    }
    if (!more) wait();
  }
}

void RingListener::connect(Ear& ear) {
  if (Clock::now() < ear.next_try) return;
  ear.next_try = Clock::now() + kListenRetry;
  try {
    door_.node = ear.node->name;
    ear.port.emplace(HostPort::connect(door_));
    ear.port->observe(order_);
    ear.is_open = true;
  } catch (const HostPortError&) {
    // Not there: `ring_status` says so, and this is tried again.
    ear.port.reset();
  }
}

void RingListener::wait() const {
  std::vector<pollfd> ports;
  for (const Ear& ear : ears_)
    if (ear.port) ports.push_back({ear.port->fd(), POLLIN, 0});
  // Interrupted or not: all are looked at in any case.
  (void)::poll(ports.data(), ports.size(), kTickMs);
}

bool RingListener::drain(Ear& ear) {
  for (int i = 0; i < kMessagesOfANode; ++i) {
    const auto message = ear.port->receive(0ms);
    if (!message) return false;
    on_message_(*ear.node, *message);
    if (std::holds_alternative<Disconnected>(*message)) {
      ear.is_open = false;
      ear.port.reset();
      return false;
    }
  }
  return true;
}

}  // namespace limb_ring::bridge
