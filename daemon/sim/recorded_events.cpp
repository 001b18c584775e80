#include "sim/recorded_events.h"

#include <algorithm>
#include <set>
#include <utility>

namespace limb_ring::sim {

namespace input = core::input;
using core::Line;
using core::Time;

namespace {

std::string node_text(const RecordedWindow::Life& life) {
  return "node " + std::to_string(life.node) + (life.name.empty() ? "" : " (" + life.name + ")");
}
std::string line_text(Line line) { return line == Line::first ? "" : " on the second line"; }
std::string receiver_text(wire::NodeId to) { return to == wire::kBroadcast ? "all" : "node " + std::to_string(to); }

std::string packet_text(const wire::PacketFields& packet, bool interrupt) {
  const wire::Code code = packet.code();
  const std::string attempt = code.attempt == 0 ? "" : ", try " + std::to_string(code.attempt + 1);
  const std::string what = interrupt                  ? "an INTP"
                           : wire::is_control(packet) ? "a control packet"
                                                      : "a DATP of " + std::to_string(packet.data().size) + " bytes";
  return what + " of node " + std::to_string(packet.source()) + " to " + receiver_text(packet.destination()) + attempt;
}

/// "a DATP of 20 bytes of node 3 to node 5, try 2"; of a part, what it is of.
std::string slice_text(const wire::Slice& slice) {
  using wire::SliceKind;
  const wire::PacketFields packet{slice.bytes};
  switch (slice.kind) {
    case SliceKind::whole:
    case SliceKind::interrupt:
      if (slice.bytes.size < wire::kOverhead) break;
      return packet_text(packet, slice.kind == SliceKind::interrupt);
    case SliceKind::start:
      if (slice.bytes.size < wire::kHeaderSize) break;
      return "the begin of a packet of node " + std::to_string(packet.source());
    case SliceKind::fold:
      return "a fold word";
    default:
      break;
  }
  return "a part of a packet";
}

std::string request_text(const core::SendRequest& request) {
  return "sends a DATP of " + std::to_string(request.data.size) + " bytes to " + receiver_text(request.destination) +
         ", priority " + std::to_string(request.priority) + ", channel " + std::to_string(request.channel) +
         ", token " + std::to_string(request.token);
}

/// What a CPU or a client asks for; empty: it is something else.
std::string asked_text(const CoreCall& call) {
  if (const auto* send = input_of<input::Send>(call)) return request_text(send->request);
  if (const auto* sent = input_of<input::Interrupt>(call))
    return "sends an INTP to " + receiver_text(sent->request.destination) + ", factor " +
           std::to_string(sent->request.factor) + ", token " + std::to_string(sent->request.token);
  if (const auto* pull = input_of<input::Pull>(call)) return "pulls interrupt input " + std::to_string(pull->input);
  if (input_of<input::Cancel>(call) != nullptr) return "cancels the sends of a client";
  if (input_of<input::CpuReset>(call) != nullptr) return "resets its CPU";
  if (const auto* cpu = input_of<input::CpuPresent>(call)) return cpu->present ? "has its CPU" : "loses its CPU";
  return {};
}

/// What happens to a line at a node; empty: it is something else.
std::string line_change_text(const CoreCall& call) {
  if (std::holds_alternative<CoreCall::Begins>(call.what)) return "begins";
  if (std::holds_alternative<CoreCall::Ends>(call.what)) return "ends";
  if (const auto* up = input_of<input::InputUp>(call))
    return "hears node " + std::to_string(up->from) + line_text(up->line);
  if (const auto* up = input_of<input::OutputUp>(call))
    return "is connected to node " + std::to_string(up->to) + line_text(up->line);
  if (const auto* lost = input_of<input::InputLost>(call)) return "loses its input" + line_text(lost->line);
  if (const auto* lost = input_of<input::OutputLost>(call)) return "loses its output" + line_text(lost->line);
  if (const auto* gap = input_of<input::InputGap>(call)) return "finds a gap in its input" + line_text(gap->line);
  return {};
}

/// Changes of lines that an event tells one by one.
constexpr std::size_t kMostTold = 6;

class Finder {
 public:
  Finder(const RecordedWindow& window, Time until) : window_(window), until_(until) {
    for (const RecordedWindow::Life& life : window.lives) ends_.push_back(life.ends);
  }

  RecordedEvents find() {
    for (std::size_t number = 0; number < window_.calls.size(); ++number) see(number);
    found_.background.insert(found_.background.end(), window_.under_way.begin(), window_.under_way.end());
    find_lost();
    find_unsent();
    count_lost();
    for (const RecordedWindow::Pause& pause : window_.pauses) add_span(pause, "does nothing", true).pause = pause;
    for (const RecordedWindow::Pause& pause : window_.unread)
      add_span(pause, "has a CPU that takes nothing", false).unread = pause;
    for (RecordedEvent& event : changes_)
      if (event.calls.size() > kMostTold)
        event.words += ", and " + std::to_string(event.calls.size() - kMostTold) + " more such changes";
    for (RecordedEvent& event : changes_) found_.events.push_back(std::move(event));
    auto& all = found_.events;
    all.erase(std::remove_if(all.begin(), all.end(), [&](const RecordedEvent& one) { return one.at > until_; }),
              all.end());
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& one, const auto& other) { return one.first < other.first; });
    return std::move(found_);
  }

 private:
  const RecordedWindow::Life& life_of(const CoreCall& call) const { return window_.lives[call.life]; }

  RecordedEvent& add(std::size_t call, std::string words, bool is_fault) {
    RecordedEvent& event = found_.events.emplace_back();
    event.first = call;
    event.at = window_.calls[call].at;
    event.words = std::move(words);
    event.is_fault = is_fault;
    return event;
  }
  RecordedEvent& add_span(const RecordedWindow::Pause& pause, const std::string& what, bool is_fault) {
    RecordedEvent& event = found_.events.emplace_back();
    event.first = first_from(pause.from);
    event.at = pause.from;
    event.is_fault = is_fault;
    const auto us = core::whole_nanoseconds(pause.until - pause.from).count() / 1000;
    event.words = node_text(window_.lives[pause.life]) + ' ' + what + " for " + std::to_string(us) + " us";
    return event;
  }
  std::size_t first_from(Time time) const {
    const auto found = std::find_if(window_.calls.begin(), window_.calls.end(),
                                    [time](const CoreCall& call) { return call.at >= time; });
    return static_cast<std::size_t>(found - window_.calls.begin());
  }

  void see(std::size_t number) {
    const CoreCall& call = window_.calls[number];
    if (const std::string words = line_change_text(call); !words.empty()) change(number, words);
    if (const auto* any = std::get_if<core::Input>(&call.what)) ends_[call.life].see(*any);
    if (const std::string words = asked_text(call); !words.empty())
      add(number, node_text(life_of(call)) + ' ' + words, false).calls.push_back(number);
    if (input_of<input::Cpu>(call) != nullptr) report(number);
    if (const auto* output = input_of<input::OutputReady>(call)) ready(number, *output);
  }

  // A CPU reports all the time; only what is new counts.
  void report(std::size_t number) {
    const CoreCall& call = window_.calls[number];
    const core::CpuReport& now = input_of<input::Cpu>(call)->report;
    const auto before = reports_.find(call.life);
    const bool news =
        before != reports_.end() && (now.is_news_after(before->second) || now.comes_back != before->second.comes_back);
    reports_[call.life] = now;
    if (!news) return found_.background.push_back(number);
    add(number, node_text(life_of(call)) + " hears that its CPU has changed", false).calls.push_back(number);
  }
  // Only if it takes so long that somebody notices.
  void ready(std::size_t number, const input::OutputReady& output) {
    const CoreCall& call = window_.calls[number];
    const auto key = std::make_pair(call.life, output.line);
    if (!output.ready) return void(held_.emplace(key, number));
    const auto since = held_.find(key);
    if (since == held_.end()) return;
    const std::size_t begin = since->second;
    held_.erase(since);
    if (call.at - window_.calls[begin].at <= window_.patience()) return;
    add(begin, "the line out of " + node_text(life_of(call)) + line_text(output.line) + " takes nothing for a while",
        true)
        .calls = {begin, number};
  }

  /// The nodes at a line that changes.
  std::set<std::uint8_t> touched(const CoreCall& call) const {
    std::set<std::uint8_t> nodes{life_of(call).node};
    const auto i = [](const auto* change) { return static_cast<std::size_t>(change->line); };
    if (const auto* up = input_of<input::InputUp>(call)) nodes.insert(up->from);
    if (const auto* up = input_of<input::OutputUp>(call)) nodes.insert(up->to);
    if (const auto* lost = input_of<input::InputLost>(call)) nodes.insert(ends_[call.life].in[i(lost)].other);
    if (const auto* lost = input_of<input::OutputLost>(call)) nodes.insert(ends_[call.life].out[i(lost)].other);
    if (const auto* gap = input_of<input::InputGap>(call)) nodes.insert(ends_[call.life].in[i(gap)].other);
    return nodes;
  }
  void change(std::size_t number, const std::string& words) {
    const CoreCall& call = window_.calls[number];
    const std::set<std::uint8_t> nodes = touched(call);
    for (std::size_t each = changes_.size(); each-- > 0;) {
      RecordedEvent& event = changes_[each];
      const bool soon = call.at - window_.calls[event.calls.back()].at < life_of(call).settings.break_grace;
      const bool shares =
          std::any_of(nodes.begin(), nodes.end(), [&](auto node) { return nodes_[each].count(node) != 0; });
      if (!soon || !shares) continue;
      event.calls.push_back(number);
      if (event.calls.size() <= kMostTold) event.words += ", " + node_text(life_of(call)) + ' ' + words;
      nodes_[each].insert(nodes.begin(), nodes.end());
      return;
    }
    RecordedEvent event;
    event.first = number;
    event.at = call.at;
    event.words = node_text(life_of(call)) + ' ' + words;
    event.is_fault = true;
    event.calls.push_back(number);
    changes_.push_back(std::move(event));
    nodes_.push_back(nodes);
  }

  /// The event of lines that change which has lost it; null: none has.
  RecordedEvent* change_at(const Departure& left) {
    const CoreCall& call = window_.calls[left.call];
    const std::uint8_t from = life_of(call).node;
    for (std::size_t each = 0; each < changes_.size(); ++each) {
      const Time first = window_.calls[changes_[each].calls.front()].at,
                 last = window_.calls[changes_[each].calls.back()].at;
      const bool near = call.at + life_of(call).settings.break_grace >= first && call.at <= last;
      if (near && nodes_[each].count(from) != 0 && nodes_[each].count(*left.to) != 0) return &changes_[each];
    }
    return nullptr;
  }
  void find_lost() {
    using OnLine = std::tuple<std::size_t, std::uint8_t, Line>;
    std::map<OnLine, std::size_t> in_a_row;  // the event that the last slice of the line was lost in
    for (std::size_t number = 0; number < window_.departures.size(); ++number) {
      const Departure& left = window_.departures[number];
      if (!left.to) continue;
      const OnLine line{window_.calls[left.call].life, *left.to, left.line};
      if (!left.lost) {
        in_a_row.erase(line);
        continue;
      }
      if (RecordedEvent* change = change_at(left)) {
        change->lost.push_back(number);
        if (left.call < change->first) change->first = left.call;
        continue;
      }
      const auto before = in_a_row.find(line);
      if (before == in_a_row.end()) {
        in_a_row[line] = found_.events.size();
        add(left.call, lost_text(left, "loses"), true).lost.push_back(number);
      } else {
        found_.events[before->second].lost.push_back(number);
      }
      event_of_lost_[number] = in_a_row[line];
    }
  }
  /// @param does to it: "loses"
  std::string lost_text(const Departure& left, const std::string& does) const {
    return "the line from " + node_text(life_of(window_.calls[left.call])) + " to node " + std::to_string(*left.to) +
           line_text(left.line) + ' ' + does + ' ' + slice_text(left.slice);
  }
  void count_lost() {
    for (RecordedEvent& event : found_.events)
      if (event.lost.size() > 1) event.words += ", and " + std::to_string(event.lost.size() - 1) + " more behind it";
  }

  // What came changed, or late, stands for something that was lost on that line.
  void find_unsent() {
    std::map<std::pair<std::size_t, Line>, std::size_t> last;  // the event of the last one on each line
    for (const std::size_t arrival : window_.unsent) {
      const CoreCall& call = window_.calls[arrival];
      const auto line = std::make_pair(call.life, input_of<input::Receive>(call)->line);
      if (const auto lost = lost_for(call)) {
        last[line] = event_of_lost_[*lost];
        replace(*lost, arrival);
      } else if (const auto before = last.find(line); before != last.end() && goes_on(before->second, call)) {
        RecordedEvent& event = found_.events[before->second];  // more of that packet
        event.instead.push_back({event.instead.back().departure, arrival});
      } else {
        last.erase(line);
        add(arrival, unsent_text(call), true).calls.push_back(arrival);
      }
    }
  }
  std::string unsent_text(const CoreCall& call) const {
    const input::Receive& came = *input_of<input::Receive>(call);
    return slice_text(came.slice) + " comes into " + node_text(life_of(call)) + line_text(came.line) +
           ", which nobody has sent so, or not again";
  }
  void replace(std::size_t lost, std::size_t arrival) {
    RecordedEvent& event = found_.events[event_of_lost_[lost]];
    if (event.instead.empty()) event.words = replaced_text(window_.calls[arrival], window_.departures[lost]);
    event.instead.push_back({lost, arrival});
    replaced_.insert(lost);
  }
  /// It is a part of a packet and follows another one.
  bool goes_on(std::size_t event, const CoreCall& call) const {
    using wire::SliceKind;
    const SliceKind kind = input_of<input::Receive>(call)->slice.kind;
    if (kind != SliceKind::more && kind != SliceKind::end && kind != SliceKind::abort) return false;
    const CoreCall& before = window_.calls[found_.events[event].instead.back().call];
    return call.at <= before.at + window_.patience();
  }
  /// How well what came may be what has left: 0 not at all, 3 the very same.
  int likeness(const Departure& left, const CoreCall& call) const {
    const input::Receive& came = *input_of<input::Receive>(call);
    const CoreCall& from = window_.calls[left.call];
    if (*left.to != life_of(call).node || left.line != came.line) return 0;
    if (from.at > call.at + window_.patience()) return 0;
    const wire::ByteView one = left.slice.bytes, other = came.slice.bytes;
    if (std::equal(one.begin(), one.end(), other.begin(), other.end())) return 3;
    if (call.at > from.at + window_.transit + window_.patience()) return 0;
    if (look_of(life_of(from).node, left.line, came.slice) == left.look) return 2;
    return left.slice.kind == came.slice.kind || is_begin_of(left.slice, came.slice) ? 1 : 0;
  }
  static bool is_begin_of(const wire::Slice& left, const wire::Slice& came) {
    const bool cut_off = left.kind == wire::SliceKind::whole && came.kind == wire::SliceKind::start;
    return cut_off && wire::PacketFields{left.bytes}.source() == wire::PacketFields{came.bytes}.source();
  }
  std::optional<std::size_t> lost_for(const CoreCall& call) const {
    std::optional<std::size_t> found;
    int best = 0;
    for (const auto& [number, event] : event_of_lost_) {
      if (replaced_.count(number) != 0) continue;
      const int alike = likeness(window_.departures[number], call);
      if (alike <= best) continue;
      best = alike;
      found = number;
    }
    return found;
  }
  std::string replaced_text(const CoreCall& call, const Departure& left) const {
    const wire::ByteView came = input_of<input::Receive>(call)->slice.bytes;
    const bool same_bytes = std::equal(came.begin(), came.end(), left.slice.bytes.begin(), left.slice.bytes.end());
    const auto us = core::whole_nanoseconds(call.at - window_.calls[left.call].at).count() / 1000;
    return same_bytes ? lost_text(left, "delays") + " by " + std::to_string(us) + " us"
                      : lost_text(left, "damages or cuts off");
  }

  const RecordedWindow& window_;
  const Time until_;
  RecordedEvents found_;
  std::vector<LineEnds> ends_;
  std::vector<RecordedEvent> changes_;         ///< of lines
  std::vector<std::set<std::uint8_t>> nodes_;  ///< at those lines
  std::map<std::size_t, core::CpuReport> reports_;
  std::map<std::pair<std::size_t, Line>, std::size_t> held_;
  std::set<std::size_t> replaced_;                    ///< departures
  std::map<std::size_t, std::size_t> event_of_lost_;  ///< by departure
};

}  // namespace

RecordedEvents events_of(const RecordedWindow& window, Time until) { return Finder(window, until).find(); }

}  // namespace limb_ring::sim
