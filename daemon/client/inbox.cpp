#include "client/inbox.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace limb_ring::client {
namespace {

constexpr std::size_t kMaxObserved = 4096;
constexpr std::size_t kMaxOthers = 65536;

}  // namespace

void Inbox::put(Packet packet) {
  packet_turns_.push_back(arrivals_++);
  packets_[packet.priority].push_back(std::move(packet));
}

void Inbox::put(Interrupt interrupt) { interrupts_.push_back(interrupt); }

void Inbox::put(Observed observed) {
  if (observed_ >= kMaxObserved) {
    ++observed_lost_;
    return;
  }
  tell_lost();
  ++observed_;
  put_other(std::move(observed));
}

void Inbox::put(ObservedLost lost) {
  observed_lost_ += lost.count;
  if (observed_ < kMaxObserved) tell_lost();
}

void Inbox::put(CapturedPacket captured) {
  if (captured_ >= kMaxObserved) {
    captured_lost_ += 1 + captured.lost_before;
    return;
  }
  captured.lost_before += std::exchange(captured_lost_, 0);
  ++captured_;
  put_other(std::move(captured));
}

void Inbox::put_other(Message message) { others_.push_back({arrivals_++, std::move(message)}); }

void Inbox::tell_lost() {
  const std::uint64_t lost = std::exchange(observed_lost_, 0);
  if (lost > 0) put_other(ObservedLost{lost});
}

bool Inbox::packet_is_next() const {
  if (packet_turns_.empty()) return false;
  return others_.empty() || packet_turns_.front() < others_.front().arrival;
}

Packet Inbox::take_packet() {
  packet_turns_.pop_front();
  auto& queue = *std::find_if(packets_.begin(), packets_.end(), [](const auto& one) { return !one.empty(); });
  Packet packet = std::move(queue.front());
  queue.pop_front();
  return packet;
}

Message Inbox::take_other() {
  Message message = std::move(others_.front().message);
  others_.pop_front();
  if (std::holds_alternative<Observed>(message)) --observed_;
  if (std::holds_alternative<CapturedPacket>(message)) --captured_;
  if (others_.empty()) tell_lost();
  return message;
}

std::optional<Message> Inbox::take() {
  if (!interrupts_.empty()) {
    const Interrupt interrupt = interrupts_.front();
    interrupts_.pop_front();
    return interrupt;
  }
  if (packet_is_next()) return take_packet();
  if (others_.empty()) return std::nullopt;
  return take_other();
}

template <typename Kind>
std::optional<Kind> Inbox::take_with_token(std::uint32_t token) {
  const auto found = std::find_if(others_.begin(), others_.end(), [token](const Other& other) {
    const Kind* kind = std::get_if<Kind>(&other.message);
    return kind != nullptr && kind->token == token;
  });
  if (found == others_.end()) return std::nullopt;
  Kind kind = std::get<Kind>(std::move(found->message));
  others_.erase(found);
  return kind;
}

std::optional<Result> Inbox::take_result(std::uint32_t token) { return take_with_token<Result>(token); }

std::optional<Reply> Inbox::take_reply(std::uint32_t token) { return take_with_token<Reply>(token); }

bool Inbox::empty() const { return interrupts_.empty() && packet_turns_.empty() && others_.empty(); }

// Packets too: they are few, but for a daemon that gives more than it was granted.
bool Inbox::full() const { return others_.size() + interrupts_.size() + packet_turns_.size() >= kMaxOthers; }

namespace {

constexpr const char* kSpace = " \t\r\n";

std::string escaped(char c) {
  if (c == '"' || c == '\\') return {'\\', c};
  if (static_cast<unsigned char>(c) >= 0x20) return {c};
  char code[8];
  std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
  return code;
}

/// What stands at `at`, which is behind it then. Beyond ASCII, daemons write UTF-8 as it is.
char unescaped(const std::string& json, std::size_t& at) {
  const char c = json[at++];
  if (c != '\\' || at == json.size()) return c;
  constexpr const char *kLetters = "bfnrt", *kMeant = "\b\f\n\r\t";
  const char letter = json[at++];
  if (letter == 'u') {
    const std::string digits = json.substr(at, 4);
    at = std::min(at + 4, json.size());
    return static_cast<char>(std::strtoul(digits.c_str(), nullptr, 16));
  }
  const char* const known = std::strchr(kLetters, letter);
  return known != nullptr ? kMeant[known - kLetters] : letter;
}

/// True if `json` goes on with `expected` at `at`, spaces before it left out; then `at` is
/// behind it.
bool skip(const std::string& json, std::size_t& at, const std::string& expected) {
  const std::size_t found = json.find_first_not_of(kSpace, at);
  if (found == std::string::npos || json.compare(found, expected.size(), expected) != 0) {
    return false;
  }
  at = found + expected.size();
  return true;
}

}  // namespace

std::uint32_t Pending::add(Ends ends) {
  const std::uint32_t token = next_++;
  calls_.emplace(token, ends);
  return token;
}

void Pending::end(std::uint32_t token, const Result& result, Inbox& inbox) {
  const auto call = calls_.find(token);
  if (call == calls_.end()) return;
  if (call->second == Ends::with_result) {
    inbox.put(result);
  } else {
    inbox.put(Reply{token, error_json(result.reason)});
  }
  calls_.erase(call);
}

void Pending::cancel_all(const std::string& reason, Inbox& inbox) {
  while (!calls_.empty()) {
    const std::uint32_t token = calls_.begin()->first;
    end(token, {token, Outcome::cancelled, {}, 0, reason, Reason::given_up}, inbox);
  }
}

std::string error_json(const std::string& reason) {
  std::string json = "{\"error\": \"";
  for (const char c : reason) json += escaped(c);
  return json + "\"}";
}

std::string error_of(const std::string& json) {
  std::size_t at = 0;
  const bool failed = skip(json, at, "{") && skip(json, at, "\"error\"") && skip(json, at, ":");
  if (!failed) return {};
  if (!skip(json, at, "\"")) return json.substr(at);
  std::string text;
  while (at < json.size() && json[at] != '"') text += unescaped(json, at);
  return text;
}

}  // namespace limb_ring::client
