#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "client/inbox.h"

namespace limb_ring::client {

/// Calls that have not ended yet, by token. Each gets exactly one end: the daemon's, or if the
/// connection ends first, one from here.
class Pending {
 public:
  enum class Ends : std::uint8_t { with_result, with_reply };

  std::uint32_t add(Ends ends);
  /// @return false if no such call is outstanding: this is a second end, which must not be passed on
  bool remove(std::uint32_t token) { return calls_.erase(token) > 0; }
  /// One of that kind is outstanding.
  bool contains(std::uint32_t token, Ends ends) const {
    const auto call = calls_.find(token);
    return call != calls_.end() && call->second == ends;
  }
  /// Ends one here: with that result, or a Reply holding its reason as its error.
  void end(std::uint32_t token, const Result& result, Inbox& inbox);
  /// Ends all: results `cancelled`, replies with an error.
  void cancel_all(const std::string& reason, Inbox& inbox);

 private:
  std::uint32_t next_ = 1;
  std::map<std::uint32_t, Ends> calls_;
};

/// {"error": "..."}
std::string error_json(const std::string& reason);
/// The text of an error reply, empty where `json` is none. A failed reply has "error" as its first
/// member; nothing else does.
std::string error_of(const std::string& json);

}  // namespace limb_ring::client
