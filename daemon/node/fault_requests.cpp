#include "node/fault_requests.h"

#include <spdlog/spdlog.h>

#include <random>

#include "config/core_settings.h"
#include "node/request_fields.h"

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

void list_faults(const FaultTargets& to, const json&, const Answer& answer) { answer({{"faults", to.faults.list()}}); }

void remove_fault(const FaultTargets& to, const json& request, const Answer& answer) {
  if (!request.contains("id")) throw RequestError("id is missing: of the fault, as 'faults' lists it");
  const auto id = static_cast<Faults::Id>(number_in(request, "id", 0, 1, UINT32_MAX));
  if (!to.faults.remove(id, answer_when_mended(answer)))
    throw RequestError("node " + to.node.name + " has no fault " + std::to_string(id) + " (any more)");
}

void clear_faults(const FaultTargets& to, const json&, const Answer& answer) {
  to.faults.clear(answer_when_mended(answer));
}

}  // namespace limb_ring::runtime
