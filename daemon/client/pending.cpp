#include "client/pending.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace limb_ring::client {

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

/// True where `json` goes on with `expected` at `at`, spaces before it left out; then `at` is
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
