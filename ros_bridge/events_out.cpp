#include "ros_bridge/events_out.h"

#include "ros_bridge/conversions.h"
#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {
namespace {

constexpr std::uint32_t kEventsQueue = 1000;  // a restart of the ring is some ten events of every node
constexpr const char* kOrder = R"({"kinds": ["state", "link", "pin", "cpu"]})";

}  // namespace

EventsOut::EventsOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon,
                     Counters& counters, const RosClock& clock)
    : counters_(counters),
      clock_(clock),
      conversion_(ring),
      publisher_(nodes.advertise<RingEvent>("ring_events", kEventsQueue)),
      listener_(
          all_nodes(ring), daemon, kOrder,
          [this](const config::NodeConfig& node, const Message& message) { take(node, message); },
          [this](const config::NodeConfig& node) { return conversion_.is_open(node); }) {}

void EventsOut::take(const config::NodeConfig& node, const Message& message) {
  if (const auto* seen = std::get_if<Observed>(&message)) {
    for (RingEvent& event : conversion_.events_of(node, seen->json)) {
      event.header.stamp = clock_.to_ros(static_cast<std::int64_t>(event.header.stamp.toNSec()));
      publisher_.publish(event);
    }
  } else if (const auto* lost = std::get_if<ObservedLost>(&message)) {
    counters_.lose("events_lost", lost->count);
  } else if (std::holds_alternative<Disconnected>(message)) {
    publish_now(conversion_.gone(node));
  } else if (const auto* reply = std::get_if<Reply>(&message)) {
    for (const RingEvent& event : conversion_.events_of_row(node, reply->json)) publish_now(event);
  }
}

void EventsOut::publish_now(RingEvent event) {
  event.header.stamp = clock_.now();
  publisher_.publish(event);
}

namespace {

using nlohmann::json;

constexpr const char* kLeadsTo = " -> ";
const std::string kNotKnown = "unknown";  // before the bridge has heard of a node
const std::string kDown = "down";         // as NodeStatus has it

bool is_opened(const std::string& state) { return state == "open_chain" || state == "folded"; }

std::string text_of(const json& said, const char* member) {
  const auto found = said.find(member);
  return found != said.end() && found->is_string() ? found->get<std::string>() : "";
}

RingEvent event(std::uint8_t kind, const json& said) {
  RingEvent made;
  made.header.stamp = to_ros_time(number_of(said, "time_ns", 0));
  made.kind = kind;
  return made;
}

}  // namespace

std::vector<RingEvent> EventConversion::events_of(const config::NodeConfig& node, const std::string& line) {
  const json said = json::parse(line, nullptr, /*allow_exceptions=*/false);
  if (!said.is_object()) return {};
  const std::string kind = text_of(said, "kind");
  if (kind == "state") return take_state(said, node);
  if (kind == "cpu") return take_cpu(said, node);
  RingEvent made = event(RingEvent::LINK_UP, said);
  made.node = node.name;
  if (kind == "link")
    take_link(said, made);
  else if (kind == "pin")
    take_pin(said, node, made);
  else
    return {};
  return {made};
}

std::vector<RingEvent> EventConversion::events_of_row(const config::NodeConfig& node, const std::string& row) {
  const json now = json::parse(row, nullptr, /*allow_exceptions=*/false);
  const std::string state = now.is_object() ? text_of(now, "state") : "";
  if (state.empty()) return {};
  const Told told = told_[node.id];
  json said = {{"before", told.state.empty() ? kNotKnown : told.state}, {"after", state}};
  for (const char* member : {"ring_size", "broken_line"})
    if (now.contains(member)) said[member] = now[member];
  std::vector<RingEvent> all;
  if (state != told.state)
    all = take_state(said, node);
  else if (auto fault = fault_of(said))
    all.push_back(*fault);
  const auto cpu = now.find("cpu");
  if (cpu == now.end() || !cpu->is_object()) return all;
  for (RingEvent& made : take_cpu(*cpu, node)) all.push_back(std::move(made));
  return all;
}

RingEvent EventConversion::gone(const config::NodeConfig& node) {
  open_.erase(node.id);
  const std::string before = std::exchange(told_[node.id], {kDown, {}}).state;
  RingEvent made;
  made.kind = RingEvent::NODE_STATE;
  made.node = node.name;
  made.text = (before.empty() ? kNotKnown : before) + kLeadsTo + kDown;
  return made;
}

std::vector<RingEvent> EventConversion::take_state(const json& said, const config::NodeConfig& node) {
  RingEvent made = event(RingEvent::NODE_STATE, said);
  made.node = node.name;
  made.text = text_of(said, "before") + kLeadsTo + text_of(said, "after");
  made.value = number_of(said, "ring_size", 0);
  told_[node.id].state = text_of(said, "after");
  std::vector<RingEvent> all{made};
  if (auto fault = fault_of(said)) all.push_back(*fault);
  for (RingEvent& cure : cures_of(said, node)) all.push_back(std::move(cure));
  return all;
}

// A daemon also tells where only the process has changed, which is not an event of ours.
std::vector<RingEvent> EventConversion::take_cpu(const json& said, const config::NodeConfig& node) {
  RingEvent made = event(RingEvent::CPU_STATE, said);
  made.node = node.name;
  made.text = text_of(said, "state");
  made.value = number_of(said, "boots", 0);
  const std::pair<std::string, std::int64_t> now{made.text, made.value};
  if (std::exchange(told_[node.id].cpu, now) == now) return {};
  return {made};
}

std::string EventConversion::name_of(int id) const {
  return id < 0 || id > 255 ? "" : ring_.name_of(static_cast<std::uint8_t>(id));
}

void EventConversion::take_link(const json& said, RingEvent& made) const {
  made.kind = text_of(said, "is") == "up" ? RingEvent::LINK_UP : RingEvent::LINK_DOWN;
  made.text = text_of(said, "what");
  made.other_node = name_of(static_cast<int>(number_of(said, "other", -1)));
}

void EventConversion::take_pin(const json& said, const config::NodeConfig& node, RingEvent& made) const {
  made.value = number_of(said, "factor", -1);
  const bool is_pin = made.value >= 0 && made.value < static_cast<std::int64_t>(node.pins.size());
  const bool resets =
      is_pin && node.pins[static_cast<std::size_t>(made.value)].action == config::PinConfig::Action::reset;
  made.kind = resets ? RingEvent::RESET : RingEvent::INTERRUPT;
  made.other_node = name_of(static_cast<int>(number_of(said, "source", -1)));
  made.text = text_of(said, "what");
}

// Every node of the chain reports it; the first report becomes the event.
std::optional<RingEvent> EventConversion::fault_of(const json& said) {
  const auto line = said.find("broken_line");
  if (line == said.end() || !line->is_object() || !is_opened(text_of(said, "after"))) return std::nullopt;
  const Line now{static_cast<int>(number_of(*line, "before", -1)), static_cast<int>(number_of(*line, "behind", -1))};
  if (!broken_.insert(now).second) return std::nullopt;
  RingEvent made = event(RingEvent::LOCATED_FAULT, said);
  made.node = name_of(now.before);
  made.other_node = name_of(now.behind);
  made.text =
      "the line from " + made.node + " to " + made.other_node + " is broken, or " + made.node + " does not send";
  return made;
}

// As long as one node is still in an open chain the ring is not healed: the last one's change becomes the events.
std::vector<RingEvent> EventConversion::cures_of(const json& said, const config::NodeConfig& node) {
  const std::string after = text_of(said, "after");
  if (is_opened(after))
    open_.insert(node.id);
  else
    open_.erase(node.id);
  if (after != "up" || !open_.empty()) return {};
  std::vector<RingEvent> all;
  for (const Line& line : std::exchange(broken_, {})) {
    all.push_back(event(RingEvent::HEALED, said));
    all.back().node = name_of(line.before);
    all.back().other_node = name_of(line.behind);
    all.back().text = "the ring is closed again";
  }
  return all;
}

}  // namespace limb_ring::bridge
