#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "client/arguments.h"
#include "client/connection.h"
#include "io/wall_clock.h"
#include "limb_ring/host_port.h"
#include "limb_ring/reason.h"
#include "wire/packet.h"

namespace limb_ring {

using client::Clock;
using client::Pending;

namespace {

constexpr std::chrono::hours kLongest{24 * 365};
/// How often we ask a virtual clock that does not wait for us; it answers within kClockAnswer.
constexpr std::chrono::milliseconds kPoll{1};
constexpr std::chrono::seconds kClockAnswer{5};
constexpr std::string_view kNow = "\"now_ns\":";

std::chrono::nanoseconds at_most_longest(std::chrono::milliseconds timeout) {
  return std::min<std::chrono::milliseconds>(timeout, kLongest);
}

}  // namespace

struct HostPort::Impl {
  explicit Impl(client::Connection opened) : connection(std::move(opened)) {}

  /// Begins a call and sends it. The daemon checks the arguments.
  template <typename Request>
  std::uint32_t call(Request request) {
    request.token = connection.begin(Pending::Ends::with_result);
    connection.send(request);
    return request.token;
  }

  /// Reads until `taken` returns something or the deadline has passed. Other messages stay in the inbox. If nothing
  /// is here and the deadline is to come it waits first: the wait says whether there is anything to read.
  template <typename Taken>
  auto read_until(Taken taken, std::chrono::nanoseconds deadline) {
    if (connection.may_take_unread())
      if (auto got = taken()) return got;
    for (bool ready = !connection.inbox().empty() || connection.now() >= deadline;;) {
      if (ready) connection.read();
      auto got = taken();
      if (got || !connection.connected() || connection.now() >= deadline) return got;
      ready = connection.wait_until(deadline);
    }
  }

  /// The ring's time. A client that is not in lockstep with a virtual ring has to ask the daemon for it.
  std::chrono::nanoseconds now() {
    if (connection.clock() != client::ClockKind::ring) return connection.now();
    const std::uint32_t token = request(R"({"do": "clock"})");
    const auto reply =
        read_until([&] { return connection.inbox().take_reply(token); }, connection.now() + kClockAnswer);
    if (!reply) connection.forget(token);  // it would come as a message, with a token that the program never got
    const std::string answer = reply ? reply->json : "";
    const std::size_t number = answer.find(kNow);
    if (number != std::string::npos)
      last_told = std::chrono::nanoseconds(std::strtoll(answer.c_str() + number + kNow.size(), nullptr, 10));
    return last_told;
  }

  std::uint32_t request(const std::string& json) {
    const std::uint32_t token = connection.begin(Pending::Ends::with_reply);
    connection.send(client::JsonRequest{token, json});
    return token;
  }

  /// Of a wait for the end of a call; now, where that can no longer come.
  std::chrono::nanoseconds deadline_of(std::uint32_t token, Pending::Ends ends,
                                       std::chrono::milliseconds timeout) const {
    const bool may_come = connection.outstanding(token, ends);
    return connection.now() + (may_come ? at_most_longest(timeout) : std::chrono::nanoseconds{0});
  }

  client::Connection connection;
  std::chrono::nanoseconds last_told{0};  ///< by a clock that does not wait for us
  process::WallClock wall_clock;
};

// The values are those of the wire's, which a public header cannot include.
const char* to_string(Outcome outcome) { return wire::to_string(static_cast<wire::Outcome>(outcome)); }

HostPort::HostPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HostPort::HostPort(HostPort&&) noexcept = default;
HostPort& HostPort::operator=(HostPort&&) noexcept = default;
HostPort::~HostPort() = default;

HostPort HostPort::connect(const ConnectOptions& options) {
  const auto deadline = Clock::now() + at_most_longest(options.timeout);
  return HostPort(std::make_unique<Impl>(client::open_connection(options, deadline)));
}

std::uint8_t HostPort::id() const { return impl_->connection.id; }
const std::string& HostPort::name() const { return impl_->connection.name; }
const std::string& HostPort::ring() const { return impl_->connection.ring; }

std::uint32_t HostPort::send(std::uint8_t destination, const std::uint8_t* data, std::size_t size,
                             std::uint8_t priority, std::uint8_t channel) {
  if (size <= client::kMaxRequest)
    return impl_->call(client::SendRequest{0, destination, priority, channel, {data, size}});
  // More than a frame holds, so the daemon cannot be asked; the answer is what it would be.
  const client::Problem problem = *client::send_problem(size, priority, channel);
  const std::uint32_t token = impl_->connection.begin(Pending::Ends::with_result);
  impl_->connection.reject(token, problem.text, problem.why);
  return token;
}

std::uint32_t HostPort::interrupt(std::uint8_t destination, std::uint8_t factor, bool force) {
  return impl_->call(client::InterruptRequest{0, destination, factor, force});
}

std::uint32_t HostPort::pull(std::uint8_t input) { return impl_->call(client::PullRequest{0, input}); }

std::uint32_t HostPort::request(const std::string& json) {
  if (json.size() <= client::kMaxRequest) return impl_->request(json);
  const std::uint32_t token = impl_->connection.begin(Pending::Ends::with_reply);
  impl_->connection.reject(token, "request of " + std::to_string(json.size()) + " bytes, at most " +
                                      std::to_string(client::kMaxRequest) + " are possible");
  return token;
}

void HostPort::observe(const std::string& json_filter) {
  if (json_filter.size() > client::kMaxRequest) {
    throw HostPortError("observe: a filter of " + std::to_string(json_filter.size()) + " bytes, at most " +
                        std::to_string(client::kMaxRequest) + " are possible");
  }
  impl_->connection.await_turn();
  impl_->connection.send(client::ObserveRequest{json_filter});
}

void HostPort::tell_stopped(bool stopped) {
  request(stopped ? R"({"do": "stop_latched", "latched": true})" : R"({"do": "stop_latched", "latched": false})");
}

void HostPort::alive() {
  impl_->connection.await_turn();
  impl_->connection.send(client::Alive{});
}

std::chrono::nanoseconds HostPort::now() const { return impl_->now(); }

std::chrono::nanoseconds HostPort::stamp() const { return stamp_of(now()); }

std::chrono::nanoseconds HostPort::stamp_of(std::chrono::nanoseconds time) const {
  if (impl_->connection.clock() != client::ClockKind::machine) return time;
  return std::chrono::nanoseconds(impl_->wall_clock.at(process::WallClock::Steady::time_point(time)));
}

std::chrono::nanoseconds HostPort::age_of(std::int64_t stamp_ns) const {
  const std::chrono::nanoseconds time = now();
  if (impl_->connection.clock() != client::ClockKind::machine) return time - std::chrono::nanoseconds(stamp_ns);
  return impl_->wall_clock.age_of(stamp_ns, process::WallClock::Steady::time_point(time));
}

bool HostPort::in_lockstep() const { return impl_->connection.clock() == client::ClockKind::lockstep; }

void HostPort::sleep_until(std::chrono::nanoseconds time) {
  impl_->connection.stay_alive();
  if (impl_->connection.clock() != client::ClockKind::ring) return impl_->connection.sleep_until(time);
  for (; connected() && impl_->now() < time; impl_->connection.look()) std::this_thread::sleep_for(kPoll);
}

std::optional<Message> HostPort::receive_within(std::chrono::nanoseconds timeout) {
  impl_->connection.stay_alive();
  return impl_->read_until([this] { return impl_->connection.take(); }, impl_->connection.now() + timeout);
}

std::string HostPort::ask(const std::string& json, std::chrono::milliseconds timeout) {
  try {
    return reply(request(json), timeout);
  } catch (const HostPortTimeout& late) {
    throw HostPortTimeout(late.what() + (": " + json));
  }
}

std::string HostPort::reply(std::uint32_t token, std::chrono::milliseconds timeout) {
  impl_->connection.stay_alive();
  client::Inbox& inbox = impl_->connection.inbox();
  const auto ends = Pending::Ends::with_reply;
  const auto reply =
      impl_->read_until([&] { return inbox.take_reply(token); }, impl_->deadline_of(token, ends, timeout));
  if (!reply && !impl_->connection.outstanding(token, ends)) {
    throw HostPortError("token " + std::to_string(token) + ": no reply is outstanding (was it received already?)");
  }
  if (!reply) {
    throw HostPortTimeout("node " + name() + " of ring " + ring() + " did not answer within " +
                          std::to_string(timeout.count()) + " ms");
  }
  const std::string error = client::error_of(reply->json);
  if (!error.empty()) throw HostPortError(error);
  return reply->json;
}

Result HostPort::wait(std::uint32_t token, std::chrono::milliseconds timeout) {
  impl_->connection.stay_alive();
  client::Inbox& inbox = impl_->connection.inbox();
  const auto ends = Pending::Ends::with_result;
  const auto result =
      impl_->read_until([&] { return inbox.take_result(token); }, impl_->deadline_of(token, ends, timeout));
  if (result) return *result;
  if (!impl_->connection.outstanding(token, ends)) {
    throw HostPortError("token " + std::to_string(token) + ": no result is outstanding (was it received already?)");
  }
  throw HostPortTimeout("token " + std::to_string(token) + ": no result within " + std::to_string(timeout.count()) +
                        " ms");
}

bool HostPort::connected() const { return impl_->connection.connected(); }
int HostPort::fd() const { return impl_->connection.fd(); }

namespace {

struct Words {
  const char* word;
  const char* sentence;
};

/// In the order of Reason.
constexpr std::array<Words, static_cast<std::size_t>(kLastReason) + 1> kWords{{
    {"", ""},
    {"bad_size", "a packet carries 1 to 512 bytes"},
    {"bad_destination", "no node of that id is configured"},
    {"bad_priority", "priorities are 0 (highest) to 3"},
    {"bad_channel", "channels are 0 to 63, and 1 is the network controllers' own"},
    {"bad_factor", "interrupt factors are 0 to 7"},
    {"input_unwired", "this interrupt input is wired to nothing"},
    {"queue_full", "the send queue is full"},
    {"not_in_ring", "the node that was to send is not in a ring"},
    {"no_way_out", "the packet could not go onto the line in time"},
    {"needs_force", "it would reset all CPUs at once; with --force (force: true in ROS) it is sent all the same"},
    {"cpu_absent", "no CPU is there"},
    {"cpu_booting", "its CPU is booting"},
    {"cpu_failed", "its CPU has failed"},
    {"cpu_silent", "its CPU hangs and its receive buffers are full"},
    {"no_buffer", "its receive buffers are full: its CPU takes packets too slowly"},
    {"joining", "it is joining the ring"},
    {"pin_unwired", "that pin is wired to nothing"},
    {"node_missing", "it is not in the ring now: down, or bypassed"},
    {"no_return", "no try came home whole in time; it may have arrived, at most once"},
    {"open_chain", "the ring is open, so nothing returns; it may have arrived"},
    {"out_of_reach", "the ring is open, and it lies before the node that sent: it was not reached"},
    {"given_up", "given up: its CPU was reset, or the sender or its daemon went away"},
}};

const Words& words_of(Reason reason) {
  const auto index = static_cast<std::size_t>(reason);
  return kWords[index < kWords.size() ? index : 0];
}

}  // namespace

const char* to_string(Reason reason) { return words_of(reason).word; }
const char* sentence(Reason reason) { return words_of(reason).sentence; }

}  // namespace limb_ring
