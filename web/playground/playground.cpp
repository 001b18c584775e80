// The simulator behind the page of a browser tab: one function that takes a request and gives an answer, both as JSON.
// The ring is that of a scenario under a virtual clock (sim/stage.h); the page asks for time to go on. (ours)

#include "core/time.h"  // before anything that reads <chrono>

#include <isa-l/crc.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "config/fault_parse.h"
#include "config/load_ring.h"
#include "judge/percentiles.h"
#include "sim/load_scenario.h"
#include "sim/scenario_report.h"
#include "sim/scenario_run.h"
#include "study/cases.h"
#include "tools/common/picture_page.h"
#include "tools/common/timeline.h"
#include "wire/pcapng.h"

/// ISA-L is written for processors; this is the same CRC, by a table. (wire/checksum.cpp)
extern "C" std::uint32_t crc32_gzip_refl(std::uint32_t before, const std::uint8_t* bytes, std::uint64_t size) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t i = 0; i < made.size(); ++i) {
      made[i] = i;
      for (int bit = 0; bit < 8; ++bit) made[i] = made[i] >> 1 ^ (made[i] & 1 ? 0xEDB88320u : 0u);
    }
    return made;
  }();
  std::uint32_t crc = ~before;
  for (std::uint64_t i = 0; i < size; ++i) crc = table[(crc ^ bytes[i]) & 0xFF] ^ crc >> 8;
  return ~crc;
}

namespace limb_ring::playground {
namespace {

using nlohmann::json;
using std::chrono::nanoseconds;
using wire::NodeId;

constexpr std::size_t kListed = 20000;    ///< packets and events in one answer; later ones are counted
constexpr std::size_t kRoundTrips = 512;  ///< kept of each node, the newest

double us(core::Duration time) { return statistics::microseconds(time); }
double us(core::Time time) { return us(time.time_since_epoch()); }

/// What happens on the lines out of all nodes, until it is told.
class Lately : public sim::Observer {
 public:
  /// @param ring outlives this
  Lately(sim::VirtualRing& ring, const config::RingConfig& config) : ring_(ring), config_(config), nodes_(ring.size()) {
    ring.add_observer(*this);
  }

  struct Node {
    json going;               ///< the packet that leaves it: as in `packets`, its end unknown; null: none
    std::uint64_t bytes = 0;  ///< all that have left
    std::uint64_t packets = 0;
    std::vector<core::Duration> round_trips;
  };
  Node& of(NodeId node) { return nodes_[node]; }
  std::uint64_t slices() const { return slices_; }

  /// {"packets": [[begins us, ends us or null, line, source, kind, bytes] ...], "happened": [...], "left_out": n}
  json take() {
    json all{{"packets", std::exchange(packets_, json::array())},
             {"happened", std::exchange(happened_, json::array())},
             {"left_out", std::exchange(left_out_, 0)}};
    for (const Node& node : nodes_)
      if (!node.going.is_null()) all["packets"].push_back(node.going);
    return all;
  }
  void say(core::Time at, NodeId node, const std::string& text) {
    put(happened_, {{"time_ns", us(at) * 1000}, {"node", +node}, {"text", text}});
  }

  void leaves(NodeId node, const wire::Slice& slice, core::Time now) override {
    using Kind = wire::SliceKind;
    ++slices_;
    Node& of = nodes_[node];
    of.bytes += slice.bytes.size;
    if (slice.kind == Kind::idle || slice.kind == Kind::fold) return;
    const double end = us(now + ring_.settings(node).byte_time_out * static_cast<std::int64_t>(slice.bytes.size));
    const wire::PacketFields fields{slice.bytes};
    if (slice.kind == Kind::interrupt)
      return put(packets_, json::array({us(now), end, +node, +fields.source(), 2, slice.bytes.size}));
    if (slice.kind == Kind::start || slice.kind == Kind::whole)
      of.going = json::array({us(now), nullptr, +node, +fields.source(), 0, 0});
    if (of.going.is_null()) return;
    of.going[5] = of.going[5].get<std::size_t>() + slice.bytes.size;
    if (slice.kind == Kind::start || slice.kind == Kind::more) return;
    of.going[1] = end;
    if (slice.kind != Kind::abort && wire::channel_of(fields.last()) == wire::id_of(wire::Channel::control))
      of.going[4] = 1;
    ++of.packets;
    put(packets_, std::exchange(of.going, {}));
  }
  void event(NodeId node, const core::Event& event) override {
    if (const auto* change = std::get_if<core::StateChanged>(&event.what))
      say(event.at, node, std::string(to_string(change->before)) + " -> " + to_string(change->after));
    if (const auto* pin = std::get_if<core::PinPulled>(&event.what))
      say(event.at, node, "pin " + std::to_string(pin->factor) + " pulled by " + config_.nodes[pin->source].name);
    if (const auto* peer = std::get_if<core::PeerChanged>(&event.what)) peer_changes(node, peer->node, event.at);
    const auto* end = std::get_if<core::SendEnded>(&event.what);
    if (end == nullptr || end->interrupt || end->outcome != core::Outcome::delivered) return;
    auto& trips = nodes_[node].round_trips;
    if (trips.size() == kRoundTrips) trips.erase(trips.begin());
    trips.push_back(end->round_trip);
  }
  void incident(NodeId node, sim::Incident what, core::Time at, core::Line) override {
    using sim::Incident;
    if (what == Incident::killed) nodes_[node].going = {};
    if (what != Incident::lost_slice && what != Incident::output_replaced) say(at, node, to_string(what));
  }

 private:
  void put(json& list, json what) { list.size() < kListed ? list.push_back(std::move(what)) : void(++left_out_); }
  /// What the CPU of a node does, in the words of the first one that is told of it.
  void peer_changes(NodeId by, NodeId of, core::Time at) {
    const core::Peer& peer = ring_.controller(by).membership().peers()[of];
    if (!peer.beacon_heard) return;
    const std::string text =
        std::string("CPU ") + to_string(peer.beacon.cpu_state) + ", boot " + std::to_string(peer.beacon.cpu_boots);
    if (std::exchange(cpus_[of], text) != text) say(at, of, text);
  }

  sim::VirtualRing& ring_;
  const config::RingConfig& config_;
  std::vector<Node> nodes_;
  std::map<NodeId, std::string> cpus_;
  json packets_ = json::array(), happened_ = json::array();
  std::size_t left_out_ = 0;
  std::uint64_t slices_ = 0;
};

core::Duration duration_of(double us) { return core::Duration{static_cast<std::int64_t>(us * 1e6)}; }

config::RingConfig ring_of(const json& request) {
  const std::string text = request.value("ring", "");
  config::RingConfig ring =
      text.empty() ? config::plain_ring("plain", request.value("nodes", 16u)) : config::parse_ring(text, "ring.yaml");
  return sim::with_assumed_lines(std::move(ring), request.value("rate", sim::kUsualRate),
                                 nanoseconds(request.value("delay_ns", std::int64_t{512})));
}

/// {"ring": YAML, or "nodes": 2 to 255; "rate": bit/s, "delay_ns" of lines without; "seed"; "size": bytes, "every_us":
/// of what each CPU sends to all}
scenario::Scenario scenario_of(const json& request) {
  scenario::Scenario scenario;
  scenario.name = "playground";
  scenario.ring = ring_of(request);
  scenario.seed = request.value("seed", std::uint64_t{1});
  return scenario;
}

/// The ring that the page shows. Nodes are places in ring order, for the page too.
class Shown {
 public:
  explicit Shown(const json& request)
      : scenario_(scenario_of(request)),
        stage_(scenario_, scenario_.seed),
        lately_(stage_.ring(), scenario_.ring),
        before_(stage_.ring().size()) {
    if (const auto problem = stage_.begin())
      throw std::runtime_error("expected: " + problem->expected + "; seen: " + problem->seen);
    if (request.value("every_us", 0.0) > 0) load(request.value("size", 64u), request.at("every_us"));
  }

  json description() const {
    json nodes = json::array();
    for (const auto& node : scenario_.ring.nodes)
      nodes.push_back({{"id", nodes.size()}, {"name", node.name}, {"joints", json::array()}});
    return {{"ring", scenario_.ring.ring}, {"folds_back", scenario_.ring.folds_back()}, {"nodes", nodes}};
  }

  /// Time goes on. @param most slices, so that the page stays fluid; time then ends earlier
  json run(double for_us, std::uint64_t most) {
    const std::uint64_t enough = lately_.slices() + most;
    stage_.run_until([&] { return lately_.slices() >= enough; }, stage_.now() + duration_of(for_us), "");
    json all = lately_.take();
    all["now_us"] = us(ring().now());
    return all;
  }

  json status() {
    json rows = json::array(), broken;
    unsigned up = 0;  // in a ring, or in a chain
    for (unsigned place = 0; place < stage_.size(); ++place) {
      const auto id = static_cast<NodeId>(place);
      rows.push_back(row(id));
      if (stage_.alive(id) && membership(id).accepts_sends()) ++up;
      if (!stage_.alive(id)) continue;
      if (const auto line = membership(id).broken_line())
        broken = {{"before", +line->before}, {"behind", +line->behind}};
    }
    told_at_ = ring().now();
    const auto promise = stage_.broken();
    return {{"headline", scenario_.ring.ring + ": " + std::to_string(up) + " of " + std::to_string(stage_.size()) +
                             " nodes up" + (broken.is_null() ? "" : "; a line is broken")},
            {"report", promise ? "promise broken: " + promise->expected + "; seen: " + promise->seen : ""},
            {"broken_line", broken},
            {"rows", rows}};
  }

  json node(NodeId id) {
    json counters = json::object();
    ring().counters(id).each([&](const char* name, const char*, std::uint64_t value) { counters[name] = value; });
    const auto from = ring().predecessor(id), to = ring().successor(id);
    return {{"id", +id},
            {"pid", ring().settings(id).boot},
            {"counters", counters},
            {"ring_size", stage_.ring_size(id)},
            {"cpu", {{"kind", "model"}, {"boots", report(id).cpu_boots}}},
            {"input", {{"state", from ? "up" : "down"}, {"from", from ? json(+*from) : json()}}},
            {"output", {{"state", to ? "up" : "down"}, {"to", to ? json(+*to) : json()}}}};
  }

  /// The words of the same ringctl command. @return what it says @throw std::runtime_error
  std::string order(const std::vector<std::string>& words) {
    const std::string& what = words.at(0);
    if (what == "fault" && words.at(1) == "clear") return clear();
    if (what == "fault") return fault(config::join({words.begin() + 1, words.end()}, " "));
    if (what == "reset") return pull(place_of(words.at(1)), config::PinConfig::Action::reset);
    if (what == "stop" && words.size() == 2) return pull(place_of(words[1]), config::PinConfig::Action::stop);
    throw std::runtime_error(what + ": not in a browser tab");
  }

 private:
  sim::VirtualRing& ring() { return stage_.ring(); }
  const core::Membership& membership(NodeId id) { return ring().controller(id).membership(); }

  fault::RingNodes nodes() const {
    fault::RingNodes all;
    for (const auto& node : scenario_.ring.nodes)
      all.push_back({node.name, std::to_string(node.id), static_cast<NodeId>(all.size())});
    return all;
  }
  NodeId place_of(const std::string& name) const {
    for (const auto& node : nodes())
      if (node.name == name || node.number == name) return node.id;
    throw std::runtime_error(name + ": no such node");
  }

  void load(unsigned size, double every_us) {
    scenario::Send send;
    send.name = "load";
    for (unsigned place = 0; place < stage_.size(); ++place) send.from.push_back(static_cast<NodeId>(place));
    send.to = wire::kBroadcast;
    send.size = size;
    send.priority = 2;
    send.every = nanoseconds(static_cast<std::int64_t>(every_us * 1000));
    stage_.send(send);
  }

  /// Of its CPU, as the other nodes have heard.
  wire::Beacon report(NodeId of) const {
    for (unsigned by = 0; by < stage_.size(); ++by) {
      if (by == of || !stage_.alive(static_cast<NodeId>(by))) continue;
      if (const auto beacon = stage_.heard(static_cast<NodeId>(by), of)) return *beacon;
    }
    return {};
  }

  json row(NodeId id) {
    const bool alive = stage_.alive(id);
    const auto to = ring().successor(id);
    Lately::Node &now = lately_.of(id), &before = before_[id];
    const double seconds = us(ring().now() - told_at_) / 1e6, byte_us = us(ring().settings(id).byte_time_out);
    const auto per_second = [&](std::uint64_t count) { return seconds > 0 ? json(count / seconds) : json(); };
    const std::uint64_t bytes = now.bytes - std::exchange(before.bytes, now.bytes);
    const std::uint64_t packets = now.packets - std::exchange(before.packets, now.packets);
    auto trips = now.round_trips;
    const bool silent = report(id).cpu_state == wire::CpuState::silent;
    return {{"id", +id},
            {"name", stage_.name(id)},
            {"state", alive ? to_string(stage_.state(id)) : "down"},
            {"cpu", alive ? silent ? "hung" : to_string(report(id).cpu_state) : ""},
            {"to", to ? json(+*to) : json()},
            {"load", seconds > 0 ? json(bytes * byte_us / 1e6 / seconds) : json()},
            {"bytes_per_second", per_second(bytes)},
            {"packets_per_second", per_second(packets)},
            {"round_trip_us", statistics::to_json(statistics::percentiles(trips))},
            {"output", {{"rate_bit_s", scenario_.ring.nodes[(id + 1u) % stage_.size()].link.rate}}},
            {"faults", faults_of(id)}};
  }

  json faults_of(NodeId id) {
    json list = json::array();
    for (const Lasting& one : lasting_)
      if (one.node == id && one.ends > ring().now()) list.push_back({{"fault", one.words}});
    return list;
  }

  std::string fault(const std::string& words) {
    const fault::Fault fault = fault::from_words(words, nodes());
    fault::check_second_line(fault, scenario_.ring.folds_back(), nodes());
    if (const auto problem = stage_.apply(fault)) throw std::runtime_error(problem->expected + ": " + problem->seen);
    for (const NodeId id : fault.nodes) remember(fault, id);
    return "done";
  }

  void remember(const fault::Fault& fault, NodeId id) {
    using fault::Name;
    const bool ends = fault.name == Name::heal || fault.name == Name::resume || fault.name == Name::reset ||
                      fault.name == Name::start || fault.name == Name::thaw || fault.name == Name::power_cycle;
    if (ends) forget_faults(id, fault::word_of(fault.name).of);
    if (ends || fault.name == Name::crash || fault.name == Name::step_clock) return;
    fault::Fault one = fault;
    one.nodes = {id};
    const core::Time until = fault.lasts.count() != 0 ? ring().now() + core::Duration(fault.lasts) : core::kNever;
    lasting_.push_back({id, fault::word_of(fault.name).of, fault::to_words(one, nodes()), until});
  }

  void forget_faults(NodeId id, fault::Of of) {
    const auto over = [&](const Lasting& one) { return one.node == id && one.of == of; };
    lasting_.erase(std::remove_if(lasting_.begin(), lasting_.end(), over), lasting_.end());
  }

  std::string clear() {
    for (unsigned place = 0; place < stage_.size(); ++place) {
      const std::string name = stage_.name(static_cast<NodeId>(place));
      fault("heal " + name + " -> " + stage_.name(static_cast<NodeId>((place + 1) % stage_.size())));
      for (const char* word : {"start ", "thaw ", "resume "}) fault(word + name);
    }
    return "done";
  }

  /// The first other node that lives sends the INTP.
  std::string pull(NodeId id, config::PinConfig::Action action) {
    const auto factor = config::first_pin(scenario_.ring.nodes[id], action);
    if (!factor) throw std::runtime_error("no pin of " + stage_.name(id) + " is wired to that");
    for (unsigned by = 0; by < stage_.size(); ++by) {
      if (by == id || !stage_.alive(static_cast<NodeId>(by))) continue;
      ring().interrupt(static_cast<NodeId>(by), id, *factor);
      if (action == config::PinConfig::Action::reset) forget_faults(id, fault::Of::cpu);
      return "INT" + std::to_string(*factor) + " sent by " + stage_.name(static_cast<NodeId>(by));
    }
    throw std::runtime_error("no other node is alive");
  }

  /// A fault that was begun here and has not been ended by hand.
  struct Lasting {
    NodeId node;
    fault::Of of;
    std::string words;
    core::Time ends;
  };

  const scenario::Scenario scenario_;
  scenario::VirtualStage stage_;
  Lately lately_;
  std::vector<Lately::Node> before_;  ///< counts when `status` was last told
  core::Time told_at_{};
  std::vector<Lasting> lasting_;
};

// ---- what runs at once -----------------------------------------------------------------------

/// {"case": word of `ring_sim run --case`, "nodes", "payload", "rate", "delay_ns", "seed"; "trace": true}
/// @return the figures of `ring_sim run`, the packets on all lines as `--perfetto` writes them, and that `--trace` if
/// asked
json run_case(const json& request) {
  const std::string word = request.at("case");
  const auto* which = std::find_if(std::begin(study::kCases), std::end(study::kCases),
                                   [&](study::Case one) { return to_string(one) == word; });
  if (which == std::end(study::kCases)) throw std::runtime_error(word + ": no such case");
  study::Medium medium;
  medium.nodes = request.value("nodes", medium.nodes);
  medium.payload = request.value("payload", medium.payload);
  medium.rate = request.value("rate", medium.rate);
  medium.relay_delay = nanoseconds(request.value("delay_ns", std::int64_t{512}));
  std::stringstream trace, capture, timeline;
  study::CaseRecords records;
  if (request.value("trace", false)) records.trace = &trace;
  if (request.value("timeline", true)) records.capture = &capture;
  const study::CaseResult result = run_case(*which, medium, request.value("seed", std::uint64_t{1}), records);
  if (records.capture != nullptr) app::write_timeline(timeline, capture, "the run");
  return {{"formula", study::formula_words(*which, medium)},
          {"formula_us", result.has_share ? json() : json(us(result.formula))},
          {"measured_us", result.has_share ? json() : json(us(result.measured.max()))},
          {"packets", result.measured.count()},
          {"trace_hash", sim::hash_text(result.trace_hash)},
          {"trace", trace.str()},
          {"timeline", records.capture != nullptr ? json::parse(timeline.str()) : json()}};
}

/// {"path", "text": YAML, "seed"}: a ring's file is looked for beside it, among those of `file`.
/// @return {"report": as `ringctl scenario run` prints, "as_expected", "picture": SVG of its nodes by state}
json run_scenario(const json& request) {
  const scenario::Scenario scenario = scenario::parse_scenario(request.at("text"), request.at("path"));
  std::stringstream capture;
  const auto run = scenario::run_scenario(scenario, request.value("seed", scenario.seed), &capture);
  std::vector<capture::CapturedEvent> events;
  capture::PcapngReader reader(capture, "the run");
  while (const auto record = reader.next())
    if (const auto* event = std::get_if<capture::CapturedEvent>(&*record)) events.push_back(*event);
  return {{"report", text_of(run)},
          {"as_expected", !run.unmet},
          {"picture", app::states_picture(reader.names(), events, run.lasted)}};
}

json write_file(const json& request) {
  const std::filesystem::path path = request.at("path").get<std::string>();
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path) << request.at("text").get<std::string>();
  return json::object();
}

json order(Shown& shown, const json& words) {
  const std::string command = "ringctl " + config::join(words.get<std::vector<std::string>>(), " ");
  try {
    return {{"command", command}, {"code", 0}, {"text", shown.order(words)}};
  } catch (const std::exception& problem) {
    return {{"command", command}, {"code", 2}, {"text", problem.what()}};
  }
}

json answer(const json& request) {
  static std::unique_ptr<Shown> shown;
  const std::string what = request.at("do");
  if (what == "case") return run_case(request);
  if (what == "scenario") return run_scenario(request);
  if (what == "file") return write_file(request);
  if (what == "open") shown = std::make_unique<Shown>(request);
  if (!shown) throw std::runtime_error("no ring is open");
  if (what == "open") return shown->description();
  if (what == "run") return shown->run(request.at("for_us"), request.value("most", std::uint64_t{20000}));
  if (what == "status") return shown->status();
  if (what == "node") return shown->node(static_cast<NodeId>(request.at("id").get<unsigned>()));
  if (what == "order") return order(*shown, request.at("words"));
  throw std::runtime_error(what + ": no such request");
}

}  // namespace
}  // namespace limb_ring::playground

/// @param request JSON: {"do": WORD, ...}. @return JSON, {"error": TEXT} if it could not be done; until the next call
extern "C" const char* ask(const char* request) {
  using nlohmann::json;
  static std::string text;
  try {
    text = limb_ring::playground::answer(json::parse(request)).dump(-1, ' ', false, json::error_handler_t::replace);
  } catch (const std::exception& problem) {
    text = json{{"error", problem.what()}}.dump(-1, ' ', false, json::error_handler_t::replace);
  }
  return text.c_str();
}
