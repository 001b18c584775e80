#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "config/ring_config.h"

namespace limb_ring::runtime {

class Node;

/// Answers what a client asks the daemon (daemon/host/requests.md).
class Requests {
 public:
  using Answer = std::function<void(const nlohmann::json&)>;
  explicit Requests(Node& node) : node_(node) {}

  /// `answer` is called exactly once, now or later; with {"error": ...} where it cannot be done.
  /// @param of_cpu asked by the CPU itself
  void handle(const std::string& text, bool of_cpu, const Answer& answer);

 private:
  using Json = nlohmann::json;
  void config(const Json& request, const Answer& answer);
  void latch(const Json& request, const Answer& answer);
  void ping(const Json& request, const Answer& answer);
  void reset(const Json& request, const Answer& answer);
  void shutdown(const Json& request, const Answer& answer);
  void stop_latched(const Json& request, const Answer& answer);
  void status(const Json& request, const Answer& answer);
  void stop(const Json& request, const Answer& answer);
  void sync(const Json& request, const Answer& answer);

  Node& node_;
};

}  // namespace limb_ring::runtime
