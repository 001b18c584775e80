#include "node/fault_requests.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <limits>
#include <random>

#include "config/core_settings.h"
#include "node/requests.h"

namespace limb_ring::runtime {
namespace {

using fault::Fault;
using fault::Name;
using fault::Of;
using nlohmann::json;

/// Small enough to be typed in again.
std::uint64_t drawn_seed() { return std::random_device{}() % 1'000'000 + 1; }

Fault fault_in(const json& request, const fault::RingNodes& nodes) {
  if (!request.contains("fault") || !request["fault"].is_string())
    throw RequestError("fault is missing: a text as 'ringctl fault' takes it, 'drop body -> head packets=3'");
  Fault fault = fault::from_words(request["fault"].get<std::string>(), nodes);
  const bool random =
      (fault::word_of(fault.name).keys & fault::kSeed) != 0 &&
      (fault.once_in > 1 || fault.jitter.count() > 0 || fault.name == Name::corrupt || fault.name == Name::truncate);
  if (random && fault.seed == 0) fault.seed = drawn_seed();
  return fault;
}

/// The node to which the line of the fault leads: the next in the configured ring order, by the second line the
/// previous one.
const config::NodeConfig& end_of_line(const Fault& fault, const FaultTargets& to) {
  const std::size_t nodes = to.ring.nodes.size();
  return to.ring.nodes[(setup::index_of(to.ring, to.node) + (fault.second_line ? nodes - 1 : 1)) % nodes];
}

/// Only datagrams can overtake each other.
void require_udp(const Fault& fault, const FaultTargets& to) {
  const config::NodeConfig& end = end_of_line(fault, to);
  const auto transport = config::transport_between(to.node, end);
  if (transport == config::LinkConfig::Transport::udp) return;
  throw RequestError("reorder: the line from " + to.node.name + " to " + end.name + " is " +
                     config::words_of(transport) + ", which keeps order; it needs a UDP line (transport: udp)");
}

void require_own(const Fault& fault, const FaultTargets& to) {
  const auto& word = fault::word_of(fault.name);
  if (fault.nodes != std::vector<wire::NodeId>{wire::NodeId{to.node.id}})
    throw RequestError("this is node " + to.node.name +
                       "; a fault of a line is begun at the node where the "
                       "line begins, one of a node or CPU at that node");
  if (word.of == Of::node && fault.name != Name::power_cycle)
    throw RequestError(std::string(word.word) + " is not for the daemon itself: 'ringctl fault' does it from outside");
  fault::check_second_line(fault, to.driver.has_second_line(), to.faults.nodes());
  if (fault.name == Name::reorder) require_udp(fault, to);
}

/// Answers an empty object when all is mended, or the problem.
Faults::Done answer_when_mended(const Answer& answer) {
  return [answer](const std::string& problem) { answer(problem.empty() ? json::object() : json{{"error", problem}}); };
}

}  // namespace

void begin_fault(const FaultTargets& to, const json& request, const Answer& answer) {
  const Fault fault = fault_in(request, to.faults.nodes());
  require_own(fault, to);
  const std::string words = fault::to_words(fault, to.faults.nodes());
  spdlog::warn("fault on purpose: {}", words);
  if (fault.name == Name::power_cycle) return to.power_cycle();
  if (to.faults.full())
    throw RequestError("there are " + std::to_string(Faults::kMost) + " faults here; remove some first");
  to.faults.begin(fault, [answer, words](Faults::Id id, const std::string& problem) {
    if (!problem.empty()) return answer({{"error", words + ": " + problem}});
    answer({{"id", id}, {"fault", words}});
  });
}

void list_faults(const FaultTargets& to, const json&, const Answer& answer) {
  answer({{"faults", status::to_json(to.faults.list())}});
}

void remove_fault(const FaultTargets& to, const json& request, const Answer& answer) {
  if (!request.contains("id")) throw RequestError("id is missing: of the fault, as 'faults' lists it");
  const auto id = static_cast<Faults::Id>(number_in(request, "id", 0, 1, UINT32_MAX));
  if (!to.faults.remove(id, answer_when_mended(answer)))
    throw RequestError("node " + to.node.name + " has no fault " + std::to_string(id) + " (any more)");
}

void clear_faults(const FaultTargets& to, const json&, const Answer& answer) {
  to.faults.clear(answer_when_mended(answer));
}

namespace {

using Json = nlohmann::json;
using std::chrono::nanoseconds;

constexpr std::uint64_t kLongest = 1'000'000'000'000'000'000;  // ns, 31 years

Json state_of(const ClockControl& clock) {
  Json state = Json::object();
  add_state(clock, state);
  return state;
}

nanoseconds nanoseconds_in(const Json& request, const std::string& field, std::uint64_t least, std::uint64_t most) {
  if (!request.contains(field)) throw RequestError("'" + field + "' is missing");
  return nanoseconds(static_cast<std::int64_t>(number_in(request, field, 0, least, most)));
}

double pace_in(const Json& request) {
  const auto pace = request.find("pace");
  if (pace != request.end() && *pace == "max") return std::numeric_limits<double>::infinity();
  if (pace == request.end() || !pace->is_number() || !(*pace >= 0.001 && *pace <= 1000))
    throw RequestError("'pace' is missing or out of range; allowed: a number, 0.001 to 1000, or \"max\"");
  return pace->get<double>();
}

}  // namespace

namespace clock_requests {

void pace(ClockControl& clock, const Json& request, const Answer& answer) {
  clock.set_pace(pace_in(request));
  answer(state_of(clock));
}

void pause(ClockControl& clock, const Json&, const Answer& answer) {
  clock.pause();
  answer(state_of(clock));
}

void run(ClockControl& clock, const Json&, const Answer& answer) {
  clock.run();
  answer(state_of(clock));
}

void step(ClockControl& clock, const Json& request, const Answer& answer) {
  clock.step(nanoseconds_in(request, "time_ns", 1, kLongest), [&clock, answer] { answer(state_of(clock)); });
}

void went_on_without(ClockControl& clock, const Json& request, const Answer& answer) {
  const auto whom = request.find("whom");
  if (whom == request.end() || !whom->is_string()) throw RequestError("'whom' is missing or not a string");
  clock.went_on_without(whom->get<std::string>());
  answer(Json::object());
}

void allow(ClockControl& clock, const Json& request, const Answer& answer) {
  const nanoseconds until = nanoseconds_in(request, "until_ns", 0, kLongest);
  const auto zero = request.find("outer_zero_ns");
  if (zero == request.end() || !zero->is_number_integer())
    throw RequestError("'outer_zero_ns' is missing or not a whole number");
  if (!clock.allow(until, nanoseconds(zero->get<std::int64_t>())))
    throw RequestError("this ring's clock follows no other: 'ringctl up CONFIG --clock follow' has one that does");
  answer(state_of(clock));
}

}  // namespace clock_requests

void add_state(const ClockControl& clock, Json& answer) {
  const ClockControl::State state = clock.state();
  answer["now_ns"] = state.now.count();
  answer["pace"] = std::isinf(state.pace) ? Json("max") : Json(state.pace);
  answer["paused"] = state.paused;
  answer["late_s"] = std::chrono::duration<double>(state.late).count();
  answer["lost_s"] = std::chrono::duration<double>(state.lost).count();
  if (!state.follows) return;
  answer["allowed_ns"] = state.allowed.count();
  answer["outer_zero_ns"] = state.outer_zero.count();
}

}  // namespace limb_ring::runtime
