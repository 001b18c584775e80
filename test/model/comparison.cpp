#include "model/comparison.h"

#include <algorithm>
#include <iterator>
#include <sstream>

#include "judge/replay.h"

namespace limb_ring::model {

namespace {

std::string what_goes_onto(core::Line line) {
  if (line == core::Line::second) return "8.8, 8.10, 8.11 (what goes onto the second line)";
  return "2.4, 6.4, 8.8 (what goes onto the line)";
}

/// Neighbouring parts of one DATP as one.
std::vector<Given> joined(const std::vector<Given>& slices) {
  std::vector<Given> all;
  for (const Given& slice : slices) {
    const bool goes_on = slice.kind == SliceKind::more || slice.kind == SliceKind::end;
    const bool open = !all.empty() && (all.back().kind == SliceKind::start || all.back().kind == SliceKind::more);
    if (!goes_on || !open) {
      all.push_back(slice);
      continue;
    }
    Given& last = all.back();
    last.bytes.insert(last.bytes.end(), slice.bytes.begin(), slice.bytes.end());
    if (slice.kind == SliceKind::end) last.kind = last.kind == SliceKind::start ? SliceKind::whole : SliceKind::end;
  }
  return all;
}

const char* const kKinds[] = {"?", "start", "more", "end", "whole", "interrupt", "abort", "idle", "fold"};

std::string words(const std::vector<Given>& slices) {
  std::ostringstream text;
  for (const Given& slice : slices) {
    text << kKinds[static_cast<std::size_t>(slice.kind)] << " (" << slice.bytes.size() << " B)";
    text << std::hex;
    for (std::size_t i = 0; i < slice.bytes.size(); ++i) {
      if (slice.bytes.size() > 52 && i == 12) i = slice.bytes.size() - 12, text << " ...";
      text << (slice.bytes[i] < 16 ? " 0" : " ") << int{slice.bytes[i]};
    }
    text << std::dec << "; ";
  }
  return slices.empty() ? "nothing" : text.str();
}

std::string words(const core::Event& event) {
  std::ostringstream text;
  text << picoseconds(event.at.time_since_epoch()) << " ps: ";
  if (const auto* ended = std::get_if<core::SendEnded>(&event.what))
    text << "send " << ended->token << (ended->interrupt ? " (INTP)" : "") << " to " << int{ended->destination}
         << " ended " << to_string(ended->outcome) << ", reason " << int(ended->reject) << ", round trip "
         << picoseconds(ended->round_trip) << " ps, tries " << ended->tries << ", owner " << ended->owner;
  if (const auto* pulled = std::get_if<core::PinPulled>(&event.what))
    text << "pin " << int{pulled->factor} << " pulled by " << int{pulled->source};
  if (const auto* changed = std::get_if<core::StateChanged>(&event.what))
    text << "state " << to_string(changed->before) << " -> " << to_string(changed->after);
  if (const auto* peer = std::get_if<core::PeerChanged>(&event.what)) text << "news of node " << int{peer->node};
  if (const auto* home = std::get_if<core::BeaconHome>(&event.what))
    text << "beacon home after " << picoseconds(home->round_trip) << " ps";
  return text.str();
}

std::string words(const core::ReceivedPacket& packet) {
  std::ostringstream text;
  text << "packet of " << int{packet.source} << " to " << int{packet.destination} << ", priority "
       << int{packet.priority} << ", channel " << int{packet.channel} << ", " << packet.size << " B, in at "
       << picoseconds(packet.at.time_since_epoch()) << " ps, begins with " << int{packet.data[0]};
  return text.str();
}

bool same(const std::vector<Given>& a, const std::vector<Given>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Given& x, const Given& y) { return x.kind == y.kind && x.bytes == y.bytes; });
}

template <class Predicate>
bool same_of(const std::vector<Given>& a, const std::vector<Given>& b, Predicate of_them) {
  const auto some = [&](const std::vector<Given>& all) {
    std::vector<Given> chosen;
    std::copy_if(all.begin(), all.end(), std::back_inserter(chosen), of_them);
    return chosen;
  };
  return same(some(a), some(b));
}

/// On a line without a rate an own packet and a relayed one may both become due in one instant; the one may even be
/// why the other is sent, as a beacon that tells of a new break. Which is first is open then. So it is of an own INTP
/// and an own DATP in a node that had stood still. (protocol.md section 2.4)
bool same_but_for_a_tie(const std::vector<Given>& a, const std::vector<Given>& b, int own, bool stood_still) {
  const auto is_own = [&](const Given& slice) { return slice.bytes.size() > 3 && slice.bytes[3] == own; };
  const auto is_intp = [&](const Given& slice) { return stood_still && slice.kind == SliceKind::interrupt; };
  return same_of(a, b, [&](const Given& slice) { return is_own(slice) && is_intp(slice); }) &&
         same_of(a, b, [&](const Given& slice) { return is_own(slice) && !is_intp(slice); }) &&
         same_of(a, b, [&](const Given& slice) { return !is_own(slice); });
}

}  // namespace

std::string in_words(const Difference& d) {
  return "node " + std::to_string(d.node) + " at " + std::to_string(picoseconds(d.at.time_since_epoch())) +
         " ps, protocol.md section " + d.section + "\n  specification: " + d.specified +
         "\n  core:          " + d.core + "\n  the model's node: " + d.model + d.before;
}

Comparison::Comparison(core::NetworkController& controller, Time now)
    : controller_(controller), model_(controller.settings(), now), now_(now) {
  controller.set_journal(this);
}

void Comparison::differ(std::string section, std::string specified, std::string core) {
  if (difference_) return;
  difference_ = Difference{controller_.settings().id, now_, std::move(section), std::move(specified), std::move(core),
                           model_.in_words(),         ""};
  for (const std::string& line : last_) difference_->before += "\n    " + line;
}

/// After run() all that is due has been taken.
void Comparison::nothing_left() {
  if (!ran_ || difference_) return;
  for (auto& given : model_.given) {
    const core::Line line = &given == &model_.given[1] ? core::Line::second : core::Line::first;
    if (!given.empty()) differ(what_goes_onto(line), words(joined(given)), "nothing");
    given.clear();
  }
  for (const core::Event& event : model_.events)
    if (event.at <= now_) differ("4.6, 8.1 (events)", words(event), "none");
}

void Comparison::goes_in(const core::Input& input, Time now) {
  if (difference_) return;
  nothing_left();
  if (now != kNever && now > due_)
    differ("7.4 (timers)", "something to do at " + std::to_string(picoseconds(due_.time_since_epoch())) + " ps",
           "next_deadline() was later");
  if (now != kNever) now_ = now;
  ran_ = std::holds_alternative<core::input::Run>(input);
  if (trace != 0) note(recorder::describe({now_, input}));
  model_.apply(input, now_);
  if (ran_ && stands_still_) went_on_ = now_;
  stands_still_ = stands_still_ && !ran_;
  due_ = now == kNever || stands_still_ ? kNever : std::max(now_, model_.next_deadline(now_));
}

void Comparison::note(const std::string& what) {
  last_.push_back(std::to_string(picoseconds(now_.time_since_epoch())) + " " + what.substr(0, 200));
  if (last_.size() > trace) last_.pop_front();
}

void Comparison::goes_out(core::Line line, wire::ByteView framed_slices) {
  if (difference_) return;
  ++compared_;
  std::vector<Given> given;
  wire::each_slice(framed_slices, [&](const wire::Slice& slice) {
    given.push_back({slice.kind, Bytes(slice.bytes.begin(), slice.bytes.end())});
  });
  auto& specified = model_.given[line == core::Line::second ? 1 : 0];
  if (trace != 0) note(std::string("core gives ") + (line == core::Line::second ? "2: " : "") + words(given));
  given = joined(given);
  specified = joined(specified);
  const core::Settings& settings = controller_.settings();
  if (!same(given, specified) &&
      !(settings.byte_time_out == Duration{0} && same_but_for_a_tie(given, specified, settings.id, went_on_ == now_)))
    differ(what_goes_onto(line), words(specified), words(given));
  specified.clear();
}

void Comparison::taken(const core::Event& event, Time) {
  if (difference_) return;
  ++compared_;
  auto& events = model_.events;
  const std::string what = words(event);
  if (trace != 0) note("core tells " + what);
  const auto found = std::find_if(events.begin(), events.end(),
                                  [&](const core::Event& specified) { return words(specified) == what; });
  if (found != events.end()) {
    events.erase(found);
    return;
  }
  std::string specified;
  for (const core::Event& other : events) specified += words(other) + "; ";
  differ("4.6, 8.1 (events)", specified.empty() ? "none" : specified, what);
}

void Comparison::taken(const core::ReceivedPacket& packet, Time now) {
  if (difference_) return;
  ++compared_;
  core::ReceivedPacket* specified = model_.next_packet(now);
  const std::string what = words(packet);
  if (specified == nullptr || words(*specified) != what ||
      !std::equal(packet.bytes().begin(), packet.bytes().end(), specified->bytes().begin()))
    return differ("2.3 (what the CPU gets)", specified == nullptr ? "nothing" : words(*specified), what);
  model_.packets[packet.priority].pop_front();
}

}  // namespace limb_ring::model
