#include "tools/ringctl/view.h"

#include <sys/eventfd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include "config/load_ring.h"
#include "config/quantity.h"
#include "io/program.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/packet_type.h"
#include "tools/common/command_line.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/live_dump.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/status_rows.h"
#include "tools/ringctl/top_table.h"
#include "wire/packet.h"

namespace limb_ring::ringctl {
namespace {

/// PREFIX/share/limb_ring/web, the programs being in PREFIX/lib/limb_ring.
std::string page_folder() {
  const std::filesystem::path programs = process::own_folder();
  return (programs.parent_path().parent_path() / "share" / "limb_ring" / "web").string();
}

}  // namespace

void add_view(CLI::App& app, Context& context) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* command = add_command(app, "view", "Show the ring in a browser, until Ctrl-C",
                                  "ringctl view leg8 --control", "Serves one page, and prints its address.");
  command->add_option("RING", options->ring, "Name of the ring; default: as --ring");
  command->add_flag("--control", options->control,
                    "The page may also break, mend, reset and stop, and set the pace of a virtual ring");
  command->add_option("--port", options->port, "TCP port, 0 to 65535; default 0: any that is free")
      ->transform(cli::whole(0, 65535));
  command->add_option("--address", options->address,
                      "Address of this host to listen at, in numbers; default 127.0.0.1: only this host");
  command->callback([&context, options] {
    context.action = [&context, options] {
      options->ring = choose_ring(options->ring, context.ring);
      options->folder = page_folder();
      return serve_view(*options);
    };
  });
}

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kPackets{200};         ///< between two messages of packets
constexpr milliseconds kStatus{500};          ///< between two of status, at least
constexpr int kStatusShare = 20;              ///< asking takes at most one part of so many of the time ...
constexpr milliseconds kStatusAtLeast{5000};  ///< ... but this is the longest that a page waits
constexpr milliseconds kTryAgain{1000};
constexpr std::size_t kNotTaken = 10'000;                    ///< messages; those that come then are counted
constexpr std::size_t kListed = 400;                         ///< packets in one message; the others are counted
constexpr std::chrono::microseconds kBetweenStates{40'000};  ///< joint states of one node that are shown
constexpr std::size_t kStates = 8;                           ///< of one node in one message
constexpr unsigned kLimit = 2000;                            ///< packets a second that the daemon gives
constexpr std::size_t kHappened = 200;  ///< events in one turn; of more a line says how many were left out
/// Every so many-th packet: primes, so that nodes which send in turns are all seen.
constexpr unsigned kSamples[] = {1, 2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73};

json joints_of(const config::NodeConfig& node) {
  json joints = json::array();
  for (const config::JointConfig& joint : node.joints)
    joints.push_back(
        {{"name", joint.name}, {"lower", joint.lower}, {"upper", joint.upper}, {"slides", joint.slides()}});
  return joints;
}

/// Those that are wired, and what to.
json pins_of(const config::NodeConfig& node) {
  json pins = json::array();
  for (std::size_t factor = 0; factor < node.pins.size(); ++factor) {
    const config::PinConfig& pin = node.pins[factor];
    using Action = config::PinConfig::Action;
    if (pin.action == Action::none) continue;
    pins.push_back("INT" + std::to_string(factor) + ": " + config::name_of(pin.action) +
                   (pin.action == Action::signal ? ' ' + std::to_string(pin.signal) : "") +
                   (pin.action == Action::exec ? ' ' + config::join(pin.command, " ") : ""));
  }
  return pins;
}

/// Interrupt inputs that are wired, and what pulling one sends.
json inputs_of(const config::NodeConfig& node, const config::RingConfig& ring) {
  json inputs = json::array();
  for (std::size_t input = 0; input < node.inputs.size(); ++input) {
    const auto& to = node.inputs[input];
    if (!to) continue;
    const config::NodeConfig* one = ring.find(to->node);
    inputs.push_back(std::to_string(input) + ": INT" + std::to_string(to->factor) + " to " +
                     (to->broadcast    ? "all"
                      : one == nullptr ? std::to_string(to->node)
                                       : one->name));
  }
  return inputs;
}

json described(const RingAccess& ring) {
  std::map<int, json> nodes_of_file;
  try {
    const config::RingConfig file = config::load_ring(ring.path());
    for (const config::NodeConfig& node : file.nodes)
      nodes_of_file[node.id] = {
          {"joints", joints_of(node)}, {"pins", pins_of(node)}, {"inputs", inputs_of(node, file)}};
  } catch (const config::ConfigError&) {  // it cannot be read any more, or the ring has none
  }
  json nodes = json::array();
  for (const NodeName& node : ring.nodes()) {
    json row{{"id", node.id}, {"name", node.name}, {"joints", json::array()}};
    if (const auto found = nodes_of_file.find(node.id); found != nodes_of_file.end()) row.update(found->second);
    nodes.push_back(std::move(row));
  }
  return {{"ring", ring.ring()}, {"folds_back", ring.folds_back()}, {"nodes", nodes}};
}

int packet_kind(const CapturedPacket& packet) {
  const wire::PacketFields fields{{packet.bytes.data(), packet.bytes.size()}};
  if (fields.code().interrupt) return 2;
  return wire::is_control(fields) ? 1 : 0;
}

/// What is seen at the input of one node, until it is told.
class LatelySeen {
 public:
  void add(const CapturedPacket& packet) {
    if (packet.bytes.size() < wire::kOverhead) return;
    const wire::PacketFields fields{{packet.bytes.data(), packet.bytes.size()}};
    const bool damaged = packet.info.crc_bad || packet.info.aborted || packet.info.truncated;
    if (list_.size() < kListed)
      list_.push_back(json::array({packet.time_ns / 1000, +fields.source(), +fields.destination(), packet_kind(packet),
                                   packet.bytes.size(), damaged ? 1 : 0}));
    if (!damaged && packet_kind(packet) == 0) add_joints(fields, packet.time_ns / 1000);
  }
  void add(const CaptureCounts& counts) {
    const std::uint64_t seen = counts.seen - std::min(counts.seen, counted_);
    counted_ = counts.seen;
    const auto now = steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - counted_at_).count();
    counted_at_ = now;
    if (seconds > 0.5) rate_ = static_cast<double>(seen) / seconds;
  }
  double rate() const { return rate_; }  ///< packets a second on the line
  void start_anew() { counted_ = 0; }

  /// As the message `packets`, without where; nothing is left.
  json take() {
    json all{{"list", std::exchange(list_, json::array())}, {"joints", json::object()}};
    for (const auto& [node, states] : std::exchange(joints_, {})) all["joints"][std::to_string(node)] = states;
    return all;
  }

 private:
  void add_joints(const wire::PacketFields& fields, std::int64_t time_us) {
    const wire::ByteView data = fields.data();
    if (wire::channel_of(fields.last()) != wire::id_of(wire::Channel::joint)) return;
    if (!payload::is_type({data.data, data.size}, payload::PacketType::joint_state)) return;
    json& states = joints_[fields.source()];
    if (!states.empty() && std::abs(time_us - states.back()[0].get<std::int64_t>()) < kBetweenStates.count()) return;
    const auto state = payload::decode_joint_state({data.data, data.size});
    if (!state || states.size() >= kStates) return;
    json row = json::array({time_us});
    for (const auto& joint : state->joints) row.push_back(joint.position);
    states.push_back(std::move(row));
  }

  json list_ = json::array();
  std::map<int, json> joints_;  ///< by node: [time in us, positions ...] each
  std::uint64_t counted_ = 0;
  steady_clock::time_point counted_at_ = steady_clock::now();
  double rate_ = 0;
};

/// A ring while somebody looks at it.
class Look {
 public:
  using Tell = std::function<void(const std::string& event, std::string json)>;
  using Keep = std::function<void(const Rows& rows)>;

  /// @param keep given the rows of each status, before that is told
  Look(const RingAccess& ring, Tell to, Keep keep)
      : ring_(ring),
        tell_(std::move(to)),
        keep_(std::move(keep)),
        poll_(
            ring, [this](std::size_t node) { return order(node); },
            [this](std::size_t node, const Message& message) { seen(node, message); }) {
    tell("ring", described(ring).dump());  // seen at once, whatever asking takes
    ask();
  }

  /// One turn: what has been seen, and the status if it is due.
  void turn() {
    poll_.listen(steady_clock::now() + kPackets);
    tell_packets();
    tell_happened();
    if (steady_clock::now() < next_status_) return;
    ask();
    choose_node();
  }

 private:
  void ask() {
    const auto began = steady_clock::now();
    before_ = std::exchange(now_, poll_.sample());
    if (before_.rows.empty()) before_ = now_;
    keep_(now_.rows);
    tell_status();
    const auto taken = steady_clock::now() - began;
    next_status_ = began + std::clamp<steady_clock::duration>(kStatusShare * taken, kStatus, kStatusAtLeast);
  }

  std::string order(std::size_t node) const {
    json order{{"kinds", {"state", "link", "cpu", "pin", "watchdog"}}};
    if (node == watched_) order["packets"] = {{"sample", sample_}, {"limit_per_s", kLimit}};
    return order.dump();
  }

  void seen(std::size_t node, const Message& message) {
    if (const auto* packet = std::get_if<CapturedPacket>(&message)) packets_.add(*packet);
    if (const auto* counts = std::get_if<CaptureCounts>(&message)) {
      if (node == watched_) packets_.add(*counts);
    }
    if (const auto* observed = std::get_if<Observed>(&message)) happened(node, observed->json);
  }

  void happened(std::size_t node, const std::string& text) {
    const json event = json::parse(text, nullptr, /*allow_exceptions=*/false);
    if (!event.is_object() || event.contains("error") || ++happened_ > kHappened) return;
    tell("happened", json{{"time_ns", event.value("time_ns", std::int64_t{0})},
                          {"node", ring_.nodes()[node].id},
                          {"kind", event.value("kind", "")},
                          {"text", event_words(event)}}
                         .dump());
  }

  void tell_happened() {
    if (happened_ > kHappened)
      tell("happened", json{{"text", std::to_string(happened_ - kHappened) + " more events, left out"}}.dump());
    happened_ = 0;
  }

  void tell_packets() {
    json all = packets_.take();
    all["at"] = ring_.nodes()[watched_].id;
    all["rate"] = packets_.rate();
    all["sample"] = sample_;
    tell("packets", all.dump());
  }

  void tell_status() {
    std::vector<json> rows = top_rows(before_, now_);
    json broken;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const json row = status::to_json(now_.rows[i]);
      for (const char* name : {"faults", "fold", "unanswered", "input", "output"})
        if (row.contains(name)) rows[i][name] = row[name];
      if (row["broken_line"].is_object()) broken = row["broken_line"];
    }
    const json clock = now_.clock;
    tell("status", json{{"headline", headline(ring_.ring(), now_.rows) + clock_words(clock)},
                        {"report", whole_report(now_.rows)},
                        {"clock", clock},
                        {"interval_s", now_.at_s - before_.at_s},
                        {"broken_line", broken},
                        {"rows", rows}}
                       .dump());
  }

  /// Packets are seen at a node that answers, and as many as are not too many.
  void choose_node() {
    std::size_t node = watched_;
    for (std::size_t i = 0; i < now_.rows.size() && !poll_.is_connected(node); ++i)
      node = (node + 1) % now_.rows.size();
    const double wanted = packets_.rate() / (0.75 * kLimit);
    const unsigned* sample = std::lower_bound(std::begin(kSamples), std::end(kSamples) - 1, wanted);
    const bool fits = packets_.rate() / sample_ < kLimit && packets_.rate() / sample_ > kLimit / 4.0;
    if (node == watched_ && (*sample == sample_ || fits)) return;
    const std::size_t old = std::exchange(watched_, node);
    sample_ = *sample;
    packets_.start_anew();
    if (old != watched_) poll_.observe(old);
    poll_.observe(watched_);
  }

  void tell(const char* event, std::string text) { tell_(event, std::move(text)); }

  const RingAccess& ring_;
  const Tell tell_;
  const Keep keep_;
  std::size_t watched_ = 0;  ///< place of the node at whose input packets are seen
  unsigned sample_ = 1;
  LatelySeen packets_;
  std::size_t happened_ = 0;  ///< in this turn
  StatusPoll poll_;
  StatusSample before_, now_;
  steady_clock::time_point next_status_;
};

}  // namespace

ViewedRing::ViewedRing(std::string ring) : ring_(std::move(ring)), told_fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!told_fd_.valid()) throw std::runtime_error("too many open files");
  thread_ = std::thread([this] { run(); });
}

ViewedRing::~ViewedRing() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
    looked_at_ = false;
  }
  changed_.notify_all();
  thread_.join();
}

void ViewedRing::look(bool somebody) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    looked_at_ = somebody;
  }
  changed_.notify_all();
}

void ViewedRing::put(const std::string& event, std::string text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (told_.size() < kNotTaken)
    told_.emplace_back(event, std::move(text));
  else
    ++left_out_;
  ::eventfd_write(told_fd_.get(), 1);
}

void ViewedRing::take(const Tell& tell) {
  std::vector<std::pair<std::string, std::string>> told;
  std::size_t left_out = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    eventfd_t ignored = 0;
    ::eventfd_read(told_fd_.get(), &ignored);
    told.swap(told_);
    left_out = std::exchange(left_out_, 0);
  }
  for (const auto& [event, text] : told) tell(event, text);
  if (left_out != 0)
    tell("happened", json{{"text", std::to_string(left_out) + " messages of the ring, left out"}}.dump());
}

std::string ViewedRing::row(const std::string& id) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = rows_.find(id);
  return found == rows_.end() ? "" : found->second;
}

bool ViewedRing::wait_for_somebody() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return looked_at_ || ends_; });
  return !ends_;
}

void ViewedRing::run() {
  while (wait_for_somebody()) {
    try {
      look_on();
    } catch (const std::exception& problem) {
      put("problem", json{{"text", problem.what()}}.dump());
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait_for(lock, kTryAgain, [this] { return ends_.load(); });
    }
  }
}

void ViewedRing::look_on() {
  const RingAccess ring = RingAccess::open_also_dead(ring_);
  const auto keep = [this](const Rows& rows) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const status::NodeRow& row : rows) {
      json whole = to_json(row);
      if (row.heard.empty()) whole.erase("heard");  // mostly it was not asked for
      rows_[std::to_string(row.id)] = whole.dump();
    }
  };
  Look look(
      ring, [this](const std::string& event, std::string text) { put(event, std::move(text)); }, keep);
  while (looked_at_) look.turn();
}

}  // namespace limb_ring::ringctl
