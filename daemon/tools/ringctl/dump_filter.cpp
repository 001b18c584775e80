#include "tools/ringctl/dump_filter.h"

#include <algorithm>
#include <deque>

#include "tools/ringctl/live_dump.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "wire/pcapng.h"

namespace limb_ring::ringctl {
namespace {

using nlohmann::json;

bool given(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

template <std::size_t N>
json list_of(const std::bitset<N>& set) {
  json list = json::array();
  for (std::size_t i = 0; i < N; ++i)
    if (set[i]) list.push_back(i);
  return list;
}

wire::NodeId destination_of(const std::string& word, const capture::RingNames& names) {
  return word == "all" ? wire::kBroadcast : node_of(word, names);
}

}  // namespace

wire::NodeId node_of(const std::string& word, const capture::RingNames& names) {
  for (const auto& [id, name] : names.nodes)
    if (word == name || word == std::to_string(id)) return id;
  std::vector<NodeName> nodes;
  for (const auto& [id, name] : names.nodes) nodes.push_back({id, name});
  throw unknown_node(word, names.ring, nodes);
}

capture::Choice choice_of(const FilterWords& words, const capture::RingNames& names) {
  capture::Choice choice;
  if (!words.at.empty()) {
    choice.filter.input = given(words.at, "in");
    choice.filter.output = given(words.at, "out");
  }
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) choice.filter.kinds[kind] = given(words.kinds, kKinds[kind]);
  for (const std::string& node : words.from) choice.filter.source.set(destination_of(node, names));
  for (const std::string& node : words.to) choice.filter.destination.set(destination_of(node, names));
  for (const unsigned priority : words.priority) choice.filter.priority.set(priority);
  for (const unsigned channel : words.channel) choice.filter.channel.set(channel);
  choice.sample = words.sample;
  choice.limit_per_s = words.limit;
  return choice;
}

json order_of(const capture::Choice& choice) {
  json order{{"at", json::array()},
             {"kinds", json::array()},
             {"source", list_of(choice.filter.source)},
             {"destination", list_of(choice.filter.destination)},
             {"priority", list_of(choice.filter.priority)},
             {"channel", list_of(choice.filter.channel)},
             {"sample", choice.sample},
             {"limit_per_s", choice.limit_per_s}};
  if (choice.filter.input) order["at"].push_back("in");
  if (choice.filter.output) order["at"].push_back("out");
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
    if (choice.filter.kinds[kind]) order["kinds"].push_back(kKinds[kind]);
  return order;
}

namespace {

using std::chrono::steady_clock;

/// Of a live capture the latest so many are kept: about 70 bytes each.
constexpr std::size_t kWindow = 1000000;

/// Keeps the latest packets until its time is over.
class Window final : public CaptureSink {
 public:
  explicit Window(std::chrono::nanoseconds how_long) : end_(steady_clock::now() + how_long) {}

  void packet(const CapturedPacket& packet) override {
    lost_ += packet.lost_before;
    packets_.push_back(capture::seen(packet));
    if (packets_.size() <= kWindow) return;
    packets_.pop_front();
    ++lost_;
  }
  void event(const capture::CapturedEvent& event) override {
    if (events_.size() < kWindow) events_.push_back(event);
  }
  bool flush() override { return steady_clock::now() < end_; }

  SeenPackets take(capture::RingNames names) const {
    return {std::move(names), {packets_.begin(), packets_.end()}, events_, lost_};
  }

 private:
  steady_clock::time_point end_;
  std::deque<capture::SeenPacket> packets_;
  std::vector<capture::CapturedEvent> events_;
  std::uint64_t lost_ = 0;
};

}  // namespace

void tell_problems(const capture::PcapngReader& reader) {
  for (const std::string& problem : reader.problems()) tell_user(problem);
}

SeenPackets packets_of_file(const std::string& path) {
  capture::CaptureFile file(path);
  capture::PcapngReader& reader = file.reader();
  SeenPackets seen;
  const auto read = [&] {
    while (const auto record = reader.next()) {
      if (const auto* event = std::get_if<capture::CapturedEvent>(&*record)) seen.events.push_back(*event);
      const auto* packet = std::get_if<CapturedPacket>(&*record);
      if (packet == nullptr) continue;
      seen.packets.push_back(capture::seen(*packet));
      seen.lost += packet->lost_before;
    }
  };
  while_telling({}, read, "reading " + path);
  seen.names = reader.names();
  tell_problems(reader);
  return seen;
}

SeenPackets packets_of_ring(const std::string& ring, std::chrono::nanoseconds how_long) {
  const RingAccess access = RingAccess::open(choose_ring(ring));
  capture::Choice choice;
  choice.filter.output = true;
  Window window(how_long);
  const DumpTotals totals =
      LiveDump(access, access.nodes_here(), {{"kinds", {"state", "link", "pin", "cpu"}}, {"packets", order_of(choice)}},
               window)
          .run(0);
  if (totals.all_gone) throw HostPortError("no daemon is left to look at");
  return window.take(names_of(access));
}

}  // namespace limb_ring::ringctl
