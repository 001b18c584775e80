#include "sim/recorded_window.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "core/ring_order.h"
#include "judge/observation_file.h"
#include "judge/replay.h"

namespace limb_ring::sim {

namespace input = core::input;
using core::Line;
using core::Time;
using std::chrono::nanoseconds;

namespace {

std::size_t index(Line line) { return static_cast<std::size_t>(line); }

bool ends_a_packet(const wire::Slice& slice) {
  using wire::SliceKind;
  const bool has_end =
      slice.kind == SliceKind::whole || slice.kind == SliceKind::interrupt || slice.kind == SliceKind::end;
  return has_end && slice.bytes.size >= wire::kTrailerSize + wire::kCrcSize;
}
bool begins_a_packet(const wire::Slice& slice) {
  using wire::SliceKind;
  const bool has_header =
      slice.kind == SliceKind::whole || slice.kind == SliceKind::interrupt || slice.kind == SliceKind::start;
  return has_header && slice.bytes.size >= wire::kHeaderSize;
}

}  // namespace

Look look_of(wire::NodeId from, Line line, const wire::Slice& slice) {
  Look look{from, static_cast<std::uint8_t>(line), static_cast<std::uint8_t>(slice.kind),
            static_cast<std::uint8_t>(slice.bytes.size), static_cast<std::uint8_t>(slice.bytes.size >> 8)};
  const wire::PacketFields packet{slice.bytes};
  if (begins_a_packet(slice)) look.insert(look.end(), {packet.code().attempt, packet.source()});
  if (ends_a_packet(slice)) look.insert(look.end(), {packet.destination(), packet.last()});
  if (slice.kind == wire::SliceKind::fold) look.insert(look.end(), slice.bytes.begin(), slice.bytes.end());
  return look;
}

bool LineEnds::see(const core::Input& input) {
  const auto set = [](LineEnd& end, bool up, wire::NodeId other) {
    end = {up, true, other};
    return true;
  };
  if (const auto* up = std::get_if<input::InputUp>(&input)) return set(in[index(up->line)], true, up->from);
  if (const auto* up = std::get_if<input::OutputUp>(&input)) return set(out[index(up->line)], true, up->to);
  if (const auto* lost = std::get_if<input::InputLost>(&input))
    return set(in[index(lost->line)], false, in[index(lost->line)].other);
  if (const auto* lost = std::get_if<input::OutputLost>(&input))
    return set(out[index(lost->line)], false, out[index(lost->line)].other);
  return false;
}

bool LineEnds::is_as(const LineEnds& other) const {
  const auto same = [](const LineEnd& one, const LineEnd& two) { return one.up == two.up && one.other == two.other; };
  return std::equal(in.begin(), in.end(), other.in.begin(), same) &&
         std::equal(out.begin(), out.end(), other.out.begin(), same);
}

namespace {

/// Reads one life: first into what the judge is told, then into calls.
class LifeReader final : public core::Journal, promises::ObservationSink {
 public:
  LifeReader(recorder::ReplayedLife& life, std::size_t number, RecordedWindow& window, const RecordedJudging& judging)
      : life_(life),
        number_(number),
        window_(window),
        observer_(
            life.title().settings, nanoseconds(life.title().zero), [this] { return waiting(); }, *this,
            judging.goes_on) {
    RecordedWindow::Life& kept = window.lives[number];
    kept.node = life.node();
    kept.name = life.title().node;
    kept.settings = life.title().settings;
    kept.zero = nanoseconds(life.title().zero);
    life.replay().set_journal(this);
  }
  ~LifeReader() override { life_.replay().set_journal(nullptr); }

  /// From now on calls are kept.
  void enter_window() {
    RecordedWindow::Life& kept = window_.lives[number_];
    kept.began = told_begin_;
    kept.over = told_end_;
    kept.state = recorder::bytes_of(life_.replay().controller());
    kept.ends = ends_;
    in_window_ = true;
    see_waiting();
  }
  /// The life's core is about to do its first record.
  void begin() {
    if (std::exchange(told_begin_, true)) return;
    if (in_window_) return put(CoreCall::Begins{});
    tell(RecordedWindow::Told::Kind::begins);
  }
  /// It has done a record.
  /// @param follows another life of the node follows
  void has_done(bool follows) {
    if (in_window_) look_at_pause();
    if (in_window_) see_waiting();
    if (life_.replay().next() != core::kNever) return;
    told_end_ = true;
    if (in_window_ && follows) put(CoreCall::Ends{});
    if (!in_window_) tell(follows ? RecordedWindow::Told::Kind::ends : RecordedWindow::Told::Kind::leaves);
  }
  /// The window is over.
  void leave_window() { note_unread(window_.end); }
  wire::NodeId node() const { return life_.node(); }

  void goes_in(const core::Input& input, Time now) override {
    begin();
    ends_.see(input);
    if (!in_window_) return observer_.goes_in(input, now);
    put(copied(input));
  }
  void goes_out(Line line, wire::ByteView framed_slices) override {
    begin();
    if (!in_window_) return;
    put(CoreCall::Write{line});
    const wire::ByteView kept = copied(framed_slices);
    wire::each_slice(kept, [&](const wire::Slice& slice) {
      Departure departure;
      departure.call = window_.calls.size() - 1;
      departure.line = line;
      departure.slice = slice;
      departure.look = look_of(node(), line, slice);
      window_.departures.push_back(departure);
    });
  }
  void taken(const core::Event& event, Time now) override {
    begin();
    if (!in_window_) return observer_.taken(event, now);
    put(CoreCall::TakeEvent{});
  }
  void taken(const core::ReceivedPacket& packet, Time now) override {
    begin();
    if (!in_window_) return observer_.taken(packet, now);
    put(CoreCall::TakePacket{});
  }

 private:
  std::size_t waiting() const { return life_.replay().controller().received_waiting(); }
  Time on_machine(Time own) const { return own + window_.lives[number_].zero; }
  Time now() const { return on_machine(life_.replay().now()); }

  void put(const promises::Observation& seen) override {
    window_.told.push_back({RecordedWindow::Told::Kind::sees, life_.machine_time(life_.replay().now()).count(), node(),
                            0, nanoseconds(0), seen});
  }
  template <class What>
  void put(What&& what) {
    window_.calls.push_back({now(), number_, std::forward<What>(what)});
  }
  void tell(RecordedWindow::Told::Kind kind) {
    const auto state = static_cast<std::uint8_t>(life_.replay().controller().membership().state());
    const bool begins = kind == RecordedWindow::Told::Kind::begins;
    const nanoseconds at = begins ? life_.began() : life_.machine_time(life_.replay().now());
    window_.told.push_back({kind, at.count(), node(), state, promises::longest_send(life_.title().settings), {}});
  }
  wire::ByteView copied(wire::ByteView bytes) {
    const auto& kept = window_.bytes.emplace_back(bytes.begin(), bytes.end());
    return {kept.data(), kept.size()};
  }
  core::Input copied(core::Input input) {
    if (auto* call = std::get_if<input::Receive>(&input)) call->slice.bytes = copied(call->slice.bytes);
    if (auto* call = std::get_if<input::Send>(&input)) call->request.data = copied(call->request.data);
    return input;
  }

  void look_at_pause() {
    const recorder::Replay& replay = life_.replay();
    if (replay.next() == core::kNever) return;
    const Time due = life_.replay().controller().next_deadline(replay.now());
    if (due >= replay.next() || replay.next() - due <= window_.patience()) return;
    window_.pauses.push_back({number_, on_machine(due), on_machine(replay.next())});
  }
  void see_waiting() {
    if (waiting() == 0) return note_unread(now());
    if (!unread_since_ && life_.replay().records() != 0) unread_since_ = now();
  }
  void note_unread(Time until) {
    if (!unread_since_) return;
    const Time since = *std::exchange(unread_since_, std::nullopt);
    if (until - since > life_.title().settings.refused_backoff) window_.unread.push_back({number_, since, until});
  }

  recorder::ReplayedLife& life_;
  std::size_t number_;
  RecordedWindow& window_;
  promises::NodeObserver observer_;
  LineEnds ends_;
  bool told_begin_ = false, told_end_ = false, in_window_ = false;
  std::optional<Time> unread_since_;
};

// The recording may begin in the middle of a life: then an end of which it has not told is up, with the nearest node
// that lives, unless the first that it tells is that it goes up.
void infer_ends(RecordedWindow& window, std::size_t number) {
  RecordedWindow::Life& life = window.lives[number];
  if (!life.began) return;
  LineEnds first_told = life.ends;  // of each end what was told of it first
  for (const CoreCall& call : window.calls) {
    const auto* input = call.life == number ? std::get_if<core::Input>(&call.what) : nullptr;
    LineEnds told = first_told;
    if (input == nullptr || !told.see(*input)) continue;
    first_told.each([&](LineEnd& end, Line line, bool is_input) {
      if (!end.known) end = told.at(line, is_input);
    });
  }
  const auto lives = [&](wire::NodeId node) {
    return std::any_of(window.lives.begin(), window.lives.end(), [&](const RecordedWindow::Life& other) {
      return other.node == node && other.began && !other.over;
    });
  };
  const auto neighbour = [&](bool behind) {
    const std::size_t size = life.settings.order.size();
    for (std::size_t lines = 1; lines < size; ++lines) {
      const wire::NodeId node = core::node_after(life.settings.order, life.node, behind ? lines : size - lines);
      if (lives(node)) return node;
    }
    return life.node;
  };
  life.ends.each([&](LineEnd& end, Line line, bool is_input) {
    if (end.known || (line == Line::second && !life.settings.fold_back)) return;
    end.up = !first_told.at(line, is_input).up;
    end.other = neighbour(is_input == (line == Line::second));
  });
}

/// What is compared of a slice that left and one that came in: of a whole packet not its data, but whether the CRC fits
/// it. Recordings may lack the data of a packet that only passed, and what is then made up fits.
bool same(const wire::Slice& left, const wire::Slice& came) {
  if (left.kind != came.kind || left.bytes.size != came.bytes.size) return false;
  const auto equal = [](wire::ByteView one, wire::ByteView other) {
    return std::equal(one.begin(), one.end(), other.begin(), other.end());
  };
  if (!recorder::can_be_abridged(left)) return equal(left.bytes, came.bytes);
  return equal(left.bytes.first(wire::kHeaderSize), came.bytes.first(wire::kHeaderSize)) &&
         equal(left.bytes.from(left.bytes.size - recorder::kTail),
               came.bytes.from(came.bytes.size - recorder::kTail)) &&
         left.crc_good() == came.crc_good();
}

/// Finds what became of the slices on one line from one node to another: what left with what came in, first in first
/// out. What was passed over on the way is lost.
class Matching {
 public:
  Matching(RecordedWindow& window, wire::NodeId from, std::vector<std::size_t> departures)
      : window_(window), from_(from), departures_(std::move(departures)) {}

  void match(const std::vector<std::size_t>& arrivals) {
    for (const std::size_t arrival : arrivals) match(arrival);
    for (; next_ < departures_.size(); ++next_)  // of the last it is not known: they may be under way
      if (left_at(next_) + window_.patience() < window_.end) departure(next_).lost = true;
  }

 private:
  Departure& departure(std::size_t number) { return window_.departures[departures_[number]]; }
  Time left_at(std::size_t number) { return window_.calls[departure(number).call].at; }

  void match(std::size_t arrival) {
    const CoreCall& call = window_.calls[arrival];
    const wire::Slice& came = input_of<input::Receive>(call)->slice;
    // A node's clock stands still while it reads what has come, so an arrival may show an earlier time.
    const Time latest = call.at + window_.patience();
    for (std::size_t each = next_; each < departures_.size() && left_at(each) <= latest; ++each) {
      if (!same(departure(each).slice, came)) continue;
      for (; next_ < each; ++next_) departure(next_).lost = true;
      departure(next_++).arrival = arrival;
      return;
    }
    const bool looks_alike = next_ < departures_.size() && left_at(next_) <= latest &&
                             departure(next_).look == look_of(from_, departure(next_).line, came);
    const bool left_before = next_ == 0 && !looks_alike && call.at <= window_.begin + window_.patience();
    (left_before ? window_.under_way : window_.unsent).push_back(arrival);
    if (looks_alike) departure(next_++).lost = true;  // it has changed on its way
  }

  RecordedWindow& window_;
  const wire::NodeId from_;
  std::vector<std::size_t> departures_;
  std::size_t next_ = 0;  ///< of departures_, the first that has not come in
};

core::Duration median(std::vector<core::Duration>& all) {
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return std::max<core::Duration>(*middle, nanoseconds(1));
}

/// Matches all lines of a window.
class AllLines {
 public:
  explicit AllLines(RecordedWindow& window) : window_(window) {
    for (const RecordedWindow::Life& life : window.lives) ends_.push_back(life.ends);
  }

  void match() {
    collect();
    for (auto& [line, passages] : lines_) {
      const auto& [from, to, which] = line;
      if (!is_recorded(from) || !is_recorded(to)) {
        leave(passages);
        continue;
      }
      Matching(window_, wire::NodeId{from}, passages.departures).match(passages.arrivals);
      note_transits(wire::NodeId{from}, wire::NodeId{to}, passages.departures);
    }
    window_.transit = all_.empty() ? window_.lives.front().settings.relay_delay : median(all_);
    window_.transit = std::max<core::Duration>(window_.transit, nanoseconds(1));
    for (const auto& [line, passages] : lines_) find_late(passages.departures);
    std::sort(window_.unsent.begin(), window_.unsent.end());
  }

 private:
  struct Passages {
    std::vector<std::size_t> departures, arrivals;
  };
  void collect() {
    std::size_t departure = 0;
    std::map<Look, std::size_t> seen;
    for (std::size_t number = 0; number < window_.calls.size(); ++number) {
      const CoreCall& call = window_.calls[number];
      const std::uint8_t node = window_.lives[call.life].node;
      if (std::holds_alternative<CoreCall::Begins>(call.what)) ends_[call.life] = {};
      if (const auto* change = std::get_if<core::Input>(&call.what)) ends_[call.life].see(*change);
      for (; departure < window_.departures.size() && window_.departures[departure].call == number; ++departure) {
        Departure& left = window_.departures[departure];
        left.nth = seen[left.look]++;
        const LineEnd& out = ends_[call.life].out[index(left.line)];
        if (!out.up) continue;
        left.to = out.other;
        lines_[{node, out.other, left.line}].departures.push_back(departure);
      }
      const auto* came = input_of<input::Receive>(call);
      if (came == nullptr) continue;
      lines_[{ends_[call.life].in[index(came->line)].other, node, came->line}].arrivals.push_back(number);
    }
  }
  bool is_recorded(std::uint8_t node) const {
    return std::any_of(window_.lives.begin(), window_.lives.end(),
                       [node](const auto& life) { return life.node == node; });
  }
  // A node of another host: what it sent comes as it came, and what it got is not known.
  void leave(const Passages& passages) {
    for (const std::size_t number : passages.departures) window_.departures[number].to.reset();
    window_.under_way.insert(window_.under_way.end(), passages.arrivals.begin(), passages.arrivals.end());
  }
  core::Duration taken(const Departure& left) const {
    return window_.calls[*left.arrival].at - window_.calls[left.call].at;
  }
  void note_transits(wire::NodeId from, wire::NodeId to, const std::vector<std::size_t>& departures) {
    std::vector<core::Duration> these;
    for (const std::size_t number : departures)
      if (window_.departures[number].arrival) these.push_back(taken(window_.departures[number]));
    if (these.empty()) return;
    all_.insert(all_.end(), these.begin(), these.end());
    window_.transits[{from, to}] = median(these);
  }
  bool was_paused(std::size_t call) const {
    return std::any_of(window_.pauses.begin(), window_.pauses.end(), [&](const RecordedWindow::Pause& pause) {
      return pause.life == window_.calls[call].life && pause.from <= window_.calls[call].at &&
             window_.calls[call].at <= pause.until;
    });
  }
  // Late is as good as lost, and another one in its place later.
  void find_late(const std::vector<std::size_t>& departures) {
    for (const std::size_t number : departures) {
      Departure& left = window_.departures[number];
      if (!left.arrival || taken(left) <= window_.transit + window_.patience() || was_paused(*left.arrival)) continue;
      window_.unsent.push_back(*left.arrival);
      left.arrival.reset();
      left.lost = true;
    }
  }

  RecordedWindow& window_;
  std::vector<LineEnds> ends_;
  std::map<std::tuple<std::uint8_t, std::uint8_t, Line>, Passages> lines_;
  std::vector<core::Duration> all_;
};

/// Another life of its node is there, which began later.
bool has_follower(const recorder::ReplayedRing& ring, const recorder::ReplayedLife& life) {
  return std::any_of(ring.lives().begin(), ring.lives().end(),
                     [&](const auto& other) { return other->node() == life.node() && other->began() > life.began(); });
}

void read_until(recorder::ReplayedRing& ring, std::map<recorder::ReplayedLife*, std::unique_ptr<LifeReader>>& readers,
                nanoseconds until) {
  while (recorder::ReplayedLife* life = ring.step(ring.after(until)))
    readers[life]->has_done(has_follower(ring, *life));
}

}  // namespace

RecordedWindow read_window(const std::string& folder, nanoseconds from, nanoseconds until,
                           const RecordedJudging& judging) {
  recorder::ReplayedRing ring(folder);
  RecordedWindow window;
  window.recorded_from = ring.began();
  window.begin = Time{from};
  window.end = Time{until};
  window.lives.resize(ring.lives().size());
  std::map<recorder::ReplayedLife*, std::unique_ptr<LifeReader>> readers;
  for (const auto& life : ring.lives())
    readers[life.get()] = std::make_unique<LifeReader>(*life, readers.size(), window, judging);
  read_until(ring, readers, from - nanoseconds(1));
  for (const auto& reader : readers) reader.second->enter_window();
  read_until(ring, readers, until);
  for (const auto& reader : readers) reader.second->leave_window();
  for (std::size_t life = 0; life < window.lives.size(); ++life) infer_ends(window, life);
  AllLines(window).match();
  return window;
}

}  // namespace limb_ring::sim
