#include "tools/ringctl/live_dump.h"

#include <poll.h>

#include <algorithm>
#include <deque>
#include <iostream>
#include <utility>

#include "io/signal_wait.h"
#include "tools/common/command_line.h"
#include "tools/common/packet_text.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "wire/pcapng.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kLastWords{1000};  // how long a daemon may take to count up
/// Messages taken from one node before the next node has its turn.
constexpr int kAtOnce = 1000;

}  // namespace

std::string event_words(const nlohmann::json& seen) {
  const std::string kind = seen.value("kind", "");
  if (kind == "state")
    return seen.value("before", "") + " -> " + seen.value("after", "") + ", ring of " +
           std::to_string(seen.value("ring_size", 0));
  if (kind == "cpu") return "CPU " + seen.value("state", "") + ", boot " + std::to_string(seen.value("boots", 0));
  return seen.value("what", seen.dump());
}

std::string summary(const DumpTotals& totals) {
  const CaptureCounts& nodes = totals.nodes;
  std::string text = app::counted(totals.shown, "packet") + " shown of " + std::to_string(nodes.seen) + " seen, " +
                     std::to_string(nodes.lost) + " lost" + (nodes.lost == 0 ? "" : ", read too slowly");
  const std::pair<std::uint64_t, const char*> left_out[] = {{nodes.filtered, "by the filter"},
                                                            {nodes.sampled_out, "by --sample"},
                                                            {nodes.limited, "by --limit"},
                                                            {totals.beyond, "after the last"}};
  const char* before = "; left out: ";
  for (const auto& [count, why] : left_out)
    if (count != 0) text += std::exchange(before, ", ") + std::to_string(count) + ' ' + why;
  return text;
}

LiveDump::LiveDump(const RingAccess& ring, const std::vector<NodeName>& nodes, const nlohmann::json& order,
                   CaptureSink& sink)
    : ring_(ring.ring()), sink_(sink) {
  std::string problem;
  for (const NodeName& node : nodes) {
    try {
      sources_.emplace_back(ring.connect(node, Stay::for_long));
      sources_.back().port.observe(order.dump());
    } catch (const HostPortError& error) {
      problem = error.what();
      tell_user("node " + label(node) + " is left out: " + problem);
    }
  }
  if (sources_.empty()) throw HostPortError(problem);
}

DumpTotals LiveDump::run(std::uint64_t count) {
  count_ = count;
  process::SignalWait signals;
  Progress progress(ring_);
  bool go_on = true;
  while (go_on && !full() && !all_gone()) {
    for (Source& source : sources_) drain(source);
    go_on = sink_.flush() && !process::SignalWait::asks_to_end(signals.next(milliseconds(0)));
    if (go_on && !full() && !all_gone()) wait();
    progress.tell();
  }
  totals_.all_gone = all_gone();
  end();
  return totals_;
}

bool LiveDump::all_gone() const {
  return std::all_of(sources_.begin(), sources_.end(), [](const Source& source) { return source.gone; });
}

void LiveDump::drain(Source& source) {
  for (int i = 0; i < kAtOnce && !source.gone && !full(); ++i) {
    const auto message = source.port.receive(milliseconds(0));
    if (!message) return;
    take(source, *message);
  }
}

void LiveDump::take(Source& source, const Message& message) {
  std::visit([&](const auto& what) { on(source, what); }, message);
}

void LiveDump::wait() {
  std::vector<pollfd> ports;
  for (const Source& source : sources_)
    if (!source.gone) ports.push_back({source.port.fd(), POLLIN, 0});
  ::poll(ports.data(), ports.size(), static_cast<int>(process::SignalWait::kTick.count()));
}

/// Asks for the final counts. Packets that still arrive meanwhile are counted, but not shown.
void LiveDump::end() {
  ending_ = true;
  const auto deadline = steady_clock::now() + kLastWords;
  for (Source& source : sources_) {
    if (!source.gone) source.port.observe(R"({"packets": null})");
    const std::uint32_t token = source.gone ? 0 : source.port.request(R"({"do": "latch"})");
    while (!source.gone && !source.ended && steady_clock::now() < deadline) {
      const auto message = source.port.receive(process::SignalWait::kTick);
      const Reply* reply = message ? std::get_if<Reply>(&*message) : nullptr;
      source.ended = reply != nullptr && reply->token == token;
      if (message) take(source, *message);
    }
  }
  add_up();
}

void LiveDump::add_up() {
  for (const Source& source : sources_) {
    const CaptureCounts& counts = source.counts;
    totals_.nodes.seen += std::max(counts.seen, source.received);  // one that has died has not counted up
    totals_.nodes.filtered += counts.filtered;
    totals_.nodes.sampled_out += counts.sampled_out;
    totals_.nodes.limited += counts.limited;
    // Packets that the daemon has given but that never came out here were lost in this process.
    totals_.nodes.lost += counts.lost + (counts.given - std::min(counts.given, source.received));
  }
}

void LiveDump::on(Source& source, const CapturedPacket& packet) {
  ++source.received;
  if (ending_) {
    ++totals_.beyond;
    return;
  }
  ++totals_.shown;
  sink_.packet(packet);
}

void LiveDump::on(Source& source, const CaptureCounts& counts) { source.counts = counts; }

void LiveDump::on(Source& source, const Observed& seen) {
  const nlohmann::json what = nlohmann::json::parse(seen.json, nullptr, /*allow_exceptions=*/false);
  if (!what.is_object() || ending_) return;
  if (what.contains("error")) throw UsageError(what["error"].get<std::string>());
  sink_.event({what.value("time_ns", std::int64_t{0}), wire::NodeId{source.port.id()}, event_words(what)});
}

void LiveDump::on(Source& source, const Disconnected& end) {
  source.gone = true;
  tell_user("node " + label({source.port.id(), source.port.name()}) + ": " + end.reason);
}

namespace {

constexpr const char* kNameOfOutput = "standard output";

class TextSink final : public CaptureSink {
 public:
  TextSink(const capture::RingNames& names, const app::PacketTextOptions& options) : text_(names, options) {}
  void packet(const CapturedPacket& packet) override { std::cout << text_.line(packet) << '\n'; }
  void event(const capture::CapturedEvent& event) override { std::cout << text_.line(event) << '\n'; }
  bool flush() override { return flush_to(std::cout, kNameOfOutput); }

 private:
  app::PacketText text_;
};

class JsonSink final : public CaptureSink {
 public:
  explicit JsonSink(capture::RingNames names) : names_(std::move(names)) {}
  void packet(const CapturedPacket& packet) override { std::cout << app::packet_json(packet, names_) << '\n'; }
  void event(const capture::CapturedEvent& event) override { std::cout << app::event_json(event, names_) << '\n'; }
  bool flush() override { return flush_to(std::cout, kNameOfOutput); }

 private:
  capture::RingNames names_;
};

class FileSink final : public CaptureSink {
 public:
  FileSink(const capture::RingNames& names, const std::string& path)
      : path_(path == app::kStandardOutput ? kNameOfOutput : path),
        out_(open(path) ? file_ : std::cout),
        writer_(out_, names) {}
  void packet(const CapturedPacket& packet) override {
    writer_.packet(packet.time_ns, packet.info, app::bytes_of(packet), packet.lost_before);
  }
  void event(const capture::CapturedEvent& event) override { writer_.event(event.time_ns, event.node, event.what); }
  bool flush() override { return flush_to(out_, path_); }

 private:
  /// @return false if standard output is meant
  bool open(const std::string& path) {
    if (path == app::kStandardOutput) return false;
    const std::string problem = app::open_for_writing(file_, path);
    if (!problem.empty()) throw UsageError(problem);
    return true;
  }

  std::string path_;
  std::ofstream file_;
  std::ostream& out_;
  capture::PcapngWriter writer_;
};

}  // namespace

bool CaptureSink::flush_to(std::ostream& out, const std::string& path) {
  if (&out == &std::cout && !app::is_output_read()) wanted_ = false;
  if (wanted_ && problem_.empty()) problem_ = cli::finish_writing(out, path);
  return wanted_ && problem_.empty();
}

std::unique_ptr<CaptureSink> text_sink(const capture::RingNames& names, const app::PacketTextOptions& options) {
  return std::make_unique<TextSink>(names, options);
}

std::unique_ptr<CaptureSink> json_sink(const capture::RingNames& names) { return std::make_unique<JsonSink>(names); }

std::unique_ptr<CaptureSink> file_sink(const capture::RingNames& names, const std::string& path) {
  return std::make_unique<FileSink>(names, path);
}

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
