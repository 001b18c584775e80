#include "node/ring_port.h"

#include <nlohmann/json.hpp>

#include "limb_ring/ring_directory.h"
#include "node/fault_requests.h"
#include "node/requests.h"

namespace limb_ring::virtual_host {

using nlohmann::json;
using runtime::RequestError;

namespace {

constexpr const char* kWhoseThisIs = "this is the host port of the whole ring, not of a node";

}  // namespace

RingPort::RingPort(boost::asio::io_context& io, host::HostOptions options, fault::RingNodes nodes,
                   RingRequests requests)
    : nodes_(std::move(nodes)),
      requests_(std::move(requests)),
      host_(io, options, *this),
      watch_(io, {ring_directory(options.ring), [this] { return host_.is_in_place(); },
                  [this, ring = options.ring] {
                    make_ring_directory(ring);
                    host_.listen_again();
                  },
                  [] {}}) {
  watch_.start();
}

void RingPort::close() {
  watch_.stop();
  host_.close();
}

std::optional<std::string> RingPort::on_attach(const host::ClientInfo& client) {
  if (client.role == Role::cpu) return std::string(kWhoseThisIs) + ": it has no CPU";
  return std::nullopt;
}

// ---- what only a node does ------------------------------------------------------------------

void RingPort::reject(host::ClientId client, std::uint32_t token) {
  Result result;
  result.token = token;
  result.outcome = Outcome::rejected;
  result.why = Reason::not_in_ring;
  result.reason = kWhoseThisIs;
  host_.result(client, result);
}

void RingPort::on_send(host::ClientId client, const client::SendRequest& request) { reject(client, request.token); }

void RingPort::on_interrupt(host::ClientId client, const client::InterruptRequest& request) {
  reject(client, request.token);
}

void RingPort::on_pull(host::ClientId client, const client::PullRequest& request) { reject(client, request.token); }

void RingPort::on_observe(host::ClientId client, const client::ObserveRequest&) {
  host_.observed(client, runtime::text_of({{"error", std::string(kWhoseThisIs) + ": it sees no packets"}}));
}

// ---- requests -------------------------------------------------------------------------------

void RingPort::on_request(host::ClientId client, const client::JsonRequest& request) {
  const auto answer = [this, client, token = request.token](const json& reply) {
    host_.reply(client, token, runtime::text_of(reply));
  };
  try {
    const json what = runtime::object_in(std::string(request.json), runtime::kRequestRule);
    const runtime::RequestKind* kind = runtime::find_request_kind(what);
    if (kind != nullptr) runtime::require_known_members(what, *kind);
    if (kind != nullptr && kind->name == "fault") return begin_fault(what, answer);
    if (kind != nullptr && kind->name == "clock") return answer(state());
    if (kind == nullptr || !runtime::answer_clock_request(&requests_.clock, *kind, what, answer))
      throw RequestError(std::string(kWhoseThisIs) + ": there are allow, clock, fault, pace, pause, run, step");
  } catch (const std::exception& error) {
    answer({{"error", error.what()}});
  }
}

json RingPort::state() const {
  json state = json::object();
  runtime::add_state(requests_.clock, state);
  return state;
}

void RingPort::begin_fault(const json& request, const std::function<void(const json&)>& answer) {
  if (!request.contains("fault") || !request["fault"].is_string())
    throw RequestError("fault is missing: a text as 'ringctl fault' takes it, 'kill knee'");
  const fault::Fault fault = fault::from_words(request["fault"].get<std::string>(), nodes_);
  if (fault::word_of(fault.name).of != fault::Of::node)
    throw RequestError(std::string(fault::word_of(fault.name).word) +
                       ": a fault of a line or CPU is begun at the node where it is");
  const std::string words = fault::to_words(fault, nodes_);
  requests_.fault(fault, [answer, words](const std::string& problem) {
    answer(problem.empty() ? json{{"fault", words}} : json{{"error", problem}});
  });
}

}  // namespace limb_ring::virtual_host
