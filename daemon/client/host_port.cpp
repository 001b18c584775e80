#include "limb_ring/host_port.h"

#include <algorithm>

#include "client/arguments.h"
#include "client/connection.h"
#include "client/open_connection.h"

namespace limb_ring {

using client::Clock;
using client::Pending;

namespace {

constexpr std::chrono::hours kLongest{24 * 365};

Clock::time_point deadline_in(std::chrono::milliseconds timeout) {
  return Clock::now() + std::min<std::chrono::milliseconds>(timeout, kLongest);
}

}  // namespace

struct HostPort::Impl {
  explicit Impl(client::Connection opened) : connection(std::move(opened)) {}

  /// Begins a call and sends it, unless its arguments are wrong.
  template <typename Request>
  std::uint32_t call(Request request, const std::optional<client::Problem>& problem) {
    request.token = connection.begin(Pending::Ends::with_result);
    if (problem) {
      connection.reject(request.token, problem->text, problem->why);
    } else {
      connection.send(request);
    }
    return request.token;
  }

  /// Reads until `taken` gives something or the time is over. What else comes stays in the inbox.
  template <typename Taken>
  auto read_until(Taken taken, Clock::time_point deadline) {
    for (;;) {
      connection.read();
      auto got = taken();
      if (got || !connection.connected() || Clock::now() >= deadline) return got;
      connection.wait_readable(deadline);
    }
  }

  client::Connection connection;
};

const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::delivered: return "delivered";
    case Outcome::refused: return "refused";
    case Outcome::no_such_node: return "no such node";
    case Outcome::lost: return "lost";
    case Outcome::unconfirmed: return "unconfirmed";
    case Outcome::rejected: return "rejected";
    case Outcome::cancelled: return "cancelled";
  }
  return "unknown outcome";
}

HostPort::HostPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HostPort::HostPort(HostPort&&) noexcept = default;
HostPort& HostPort::operator=(HostPort&&) noexcept = default;
HostPort::~HostPort() = default;

HostPort HostPort::connect(const ConnectOptions& options) {
  const auto deadline = deadline_in(options.timeout);
  return HostPort(std::make_unique<Impl>(client::open_connection(options, deadline)));
}

std::uint8_t HostPort::id() const { return impl_->connection.id; }
const std::string& HostPort::name() const { return impl_->connection.name; }
const std::string& HostPort::ring() const { return impl_->connection.ring; }

std::uint32_t HostPort::send(std::uint8_t destination, const std::uint8_t* data, std::size_t size,
                             std::uint8_t priority, std::uint8_t channel) {
  const client::SendRequest request{0, destination, priority, channel, {data, size}};
  return impl_->call(request, client::send_problem(size, priority, channel));
}

std::uint32_t HostPort::interrupt(std::uint8_t destination, std::uint8_t factor, bool force) {
  const client::InterruptRequest request{0, destination, factor, force};
  return impl_->call(request, client::interrupt_problem(factor));
}

std::uint32_t HostPort::pull(std::uint8_t input) {
  return impl_->call(client::PullRequest{0, input}, client::pull_problem(input));
}

std::uint32_t HostPort::request(const std::string& json) {
  client::Connection& connection = impl_->connection;
  const std::uint32_t token = connection.begin(Pending::Ends::with_reply);
  if (json.size() > client::kMaxRequest) {
    connection.reject(token, "request of " + std::to_string(json.size()) + " bytes, at most " +
                                 std::to_string(client::kMaxRequest) + " are possible");
  } else {
    connection.send(client::JsonRequest{token, json});
  }
  return token;
}

void HostPort::observe(const std::string& json_filter) {
  if (json_filter.size() > client::kMaxRequest) {
    throw HostPortError("observe: a filter of " + std::to_string(json_filter.size()) +
                        " bytes, at most " + std::to_string(client::kMaxRequest) +
                        " are possible");
  }
  impl_->connection.send(client::ObserveRequest{json_filter});
}

void HostPort::alive() { impl_->connection.send(client::Alive{}); }

std::optional<Message> HostPort::receive(std::chrono::milliseconds timeout) {
  impl_->connection.stay_alive();
  return impl_->read_until([this] { return impl_->connection.take(); }, deadline_in(timeout));
}

std::string HostPort::ask(const std::string& json, std::chrono::milliseconds timeout) {
  const auto deadline = deadline_in(timeout);
  const std::uint32_t token = request(json);
  client::Inbox& inbox = impl_->connection.inbox();
  const auto reply = impl_->read_until([&] { return inbox.take_reply(token); }, deadline);
  if (!reply) {
    throw HostPortError("node " + name() + " of ring " + ring() + " did not answer within " +
                        std::to_string(timeout.count()) + " ms: " + json);
  }
  const std::string error = client::error_of(reply->json);
  if (!error.empty()) throw HostPortError(error);
  return reply->json;
}

Result HostPort::wait(std::uint32_t token, std::chrono::milliseconds timeout) {
  impl_->connection.stay_alive();
  client::Inbox& inbox = impl_->connection.inbox();
  const auto result =
      impl_->read_until([&] { return inbox.take_result(token); }, deadline_in(timeout));
  if (result) return *result;
  if (!impl_->connection.outstanding(token)) {
    throw HostPortError("token " + std::to_string(token) +
                        ": no result is outstanding (was it received already?)");
  }
  throw HostPortError("token " + std::to_string(token) + ": no result within " +
                      std::to_string(timeout.count()) + " ms");
}

bool HostPort::connected() const { return impl_->connection.connected(); }
int HostPort::fd() const { return impl_->connection.fd(); }

}  // namespace limb_ring
