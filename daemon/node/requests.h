#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "config/ring_config.h"
#include "node/cpu_socket.h"
#include "node/event_router.h"
#include "node/fault_requests.h"
#include "node/node_driver.h"
#include "node/pin_board.h"
#include "node/send_reason.h"
#include "node/status.h"

namespace limb_ring::runtime {

/// Answers what a client asks the daemon (docs/reference/requests.md).
class Requests {
 public:
  /// What requests are for. All must outlive this.
  struct Targets {
    const config::RingConfig& ring;
    const config::NodeConfig& node;
    NodeDriver& driver;
    CpuSocket& cpu;
    EventRouter& events;
    const PinBoard& pins;
    Traffic& traffic;
    DaemonInterrupts& interrupts;
    const SendReasons& reasons;
    FaultTargets faults;
    StatusSources status;
    ClockControl* virtual_clock;  ///< null on a live ring
  };
  explicit Requests(Targets targets) : to_(std::move(targets)) {}

  /// `answer` is called exactly once, now or later; with {"error": ...} if it cannot be done.
  /// @param of_cpu asked by the CPU itself
  void handle(const std::string& text, bool of_cpu, const Answer& answer);
  /// Whether the request changes something, rather than only asking.
  static bool changes_something(const std::string& text);

 private:
  Targets to_;
  std::shared_ptr<void> here_ = std::make_shared<char>();  ///< gone with this: a virtual node may die before an answer
};

/// A request that cannot be done; what() is its answer.
struct RequestError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// JSON for a client. Bytes that are not UTF-8, as in a path, become U+FFFD.
std::string text_of(const nlohmann::json& answer);

/// What a client wrote, an object. @param problem says what it should be
/// @throw RequestError if it is none, or nested too deep
nlohmann::json object_in(const std::string& text, const char* problem);

/// The first member that is not among these, printable; nothing if all are.
std::optional<std::string> unknown_member(const nlohmann::json& object, const std::vector<std::string>& known);

/// A whole number within `least` and `most`, `otherwise` if the field is missing.
/// @throw RequestError naming the field and what is allowed
std::uint64_t number_in(const nlohmann::json& request, const std::string& field, std::uint64_t otherwise,
                        std::uint64_t least, std::uint64_t most);

/// The node a field names, by id or name. @throw RequestError listing the nodes there are
const config::NodeConfig& node_in(const config::RingConfig& ring, const nlohmann::json& request,
                                  const std::string& field);

/// As node_in, or every node: "all", or the field is missing. @return its id, or wire::kBroadcast
std::uint8_t nodes_in(const config::RingConfig& ring, const nlohmann::json& request, const std::string& field);

constexpr const char* kRequestRule = "a request is a JSON object {\"do\": \"...\", ...}";

/// A request that a daemon answers (docs/reference/requests.md). All of them are the rows of a table in requests.cpp.
struct RequestKind {
  using OfNode = void (*)(const Requests::Targets&, const nlohmann::json& request, const Answer&);
  using OfFaults = void (*)(const FaultTargets&, const nlohmann::json& request, const Answer&);
  using OfClock = void (*)(ClockControl&, const nlohmann::json& request, const Answer&);
  enum class Changes : std::uint8_t { ring, nothing };  ///< the clock of a virtual ring aside
  enum class For : std::uint8_t { anyone, cpu };

  std::string name;                  ///< its `do`
  std::vector<std::string> members;  ///< what else it may have
  Changes changes;
  For whom;
  std::variant<OfNode, OfFaults, OfClock> handler;  ///< may throw; what() is then the answer
};

/// @return that of an object's `do`; null if there is no such request
const RequestKind* find_request_kind(const nlohmann::json& request);

/// Answers a request about the clock of a virtual ring. @return false if it is about something else
/// @param clock null on a live ring @throw RequestError
bool answer_clock_request(ClockControl* clock, const RequestKind& kind, const nlohmann::json& request,
                          const Answer& answer);

/// @throw RequestError naming a member that requests of this kind do not take, and those they take
void require_known_members(const nlohmann::json& request, const RequestKind& kind);

}  // namespace limb_ring::runtime
