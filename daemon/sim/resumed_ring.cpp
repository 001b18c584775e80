#include "sim/resumed_ring.h"

#include <algorithm>
#include <map>
#include <memory>
#include <queue>
#include <set>

#include "core/archive.h"
#include "judge/observation_file.h"

namespace limb_ring::sim {

namespace input = core::input;
using core::Duration;
using core::kNever;
using core::Line;
using core::NetworkController;
using core::Time;
using promises::Observation;
using std::chrono::nanoseconds;

namespace {

/// Rounds that are judged at the end at least: a result is judged some rounds after it.
constexpr int kLastRounds = 8;
/// Beacons that pass at the end at least, with which nodes say that their receive buffers are empty.
constexpr int kLastBeacons = 3;

/// Judges all nodes, in rounds.
class Court {
 public:
  Court(const RecordedWindow& window, const RecordedJudging& judging,
        const std::function<bool(const promises::Breach&)>& breaks)
      : judging_(judging),
        judge_(
            window.lives.front().settings.fold_back,
            [this, &breaks](const promises::Breach& breach) { stops_ = stops_ || breaks(breach); }, judging.times),
        round_ends_(window.recorded_from + judging.round) {
    for (const RecordedWindow::Told& told : window.told) hear(told);
  }

  bool stops() const { return stops_; }
  /// Rounds end until then.
  void pass(nanoseconds now) {
    for (; now >= round_ends_; round_ends_ += judging_.round) judge_.round_is_over();
  }
  void begins(wire::NodeId node, const NetworkController& core, Time at) {
    open_[node] = 0;
    judge_.begins(node, static_cast<std::uint8_t>(core.membership().state()), promises::longest_send(core.settings()),
                  core::whole_nanoseconds(at.time_since_epoch()).count());
  }
  void ends(wire::NodeId node) {
    open_[node] = 0;
    judge_.ends(node);
  }
  void see(std::uint8_t node, const Observation& seen) {
    if (seen.kind == Observation::Kind::asked) ++open_[node];
    if (seen.kind == Observation::Kind::ended && open_[node] > 0) --open_[node];
    judge_.see(node, seen);
  }
  /// All sends that were asked for have ended.
  bool is_calm() const {
    return std::all_of(open_.begin(), open_.end(), [](const auto& node) { return node.second == 0; });
  }

 private:
  void hear(const RecordedWindow::Told& told) {
    using Kind = RecordedWindow::Told::Kind;
    pass(nanoseconds(told.at_ns));
    if (told.kind == Kind::sees) return see(told.node, told.seen);
    open_[told.node] = 0;
    if (told.kind == Kind::begins) judge_.begins(told.node, told.state, told.longest_send, told.at_ns);
    if (told.kind == Kind::ends) judge_.ends(told.node);
    if (told.kind == Kind::leaves) judge_.leaves(told.node);
  }

  const RecordedJudging& judging_;
  bool stops_ = false;
  promises::PromiseJudge judge_;
  nanoseconds round_ends_;
  std::map<std::uint8_t, std::uint64_t> open_;  ///< sends
};

/// One core, which goes on.
class ResumedCore final : promises::ObservationSink {
 public:
  ResumedCore(const RecordedWindow::Life& life, Court& court, const RecordedJudging& judging)
      : life_(life),
        court_(court),
        core_(life.settings, Time{}),
        observer_(
            life.settings, core::whole_nanoseconds(life.zero), [this] { return core_.received_waiting(); }, *this,
            judging.goes_on) {
    core::StateReader state({life.state.data(), life.state.size()});
    core_.archive(state);
    core_.set_journal(&observer_);
    ends = life.ends;
    alive = life.began && !life.over;
  }
  ~ResumedCore() override { core_.set_journal(nullptr); }

  NetworkController& core() { return core_; }
  wire::NodeId node() const { return life_.node; }
  Time own(Time at) const { return at - life_.zero; }
  Time on_machine(Time own) const { return own == kNever ? kNever : own + life_.zero; }

  LineEnds ends;
  bool alive;
  Time wakes = kNever;
  std::array<std::uint64_t, 2> epochs{};  ///< of its inputs: what is under way from before is lost

 private:
  void put(const Observation& seen) override { court_.see(life_.node, seen); }

  const RecordedWindow::Life& life_;
  Court& court_;
  NetworkController core_;
  promises::NodeObserver observer_;
};

class Teller {
 public:
  Teller(const RecordedWindow& window, const RecordedEvents& events, const Retelling& retelling,
         const RecordedJudging& judging, const std::function<bool(const promises::Breach&)>& breaks)
      : window_(window), events_(events), retelling_(retelling), court_(window, judging, breaks), judging_(judging) {
    for (const RecordedWindow::Life& life : window.lives)
      cores_.push_back(std::make_unique<ResumedCore>(life, court_, judging));
  }

  bool tell() {
    now_ = window_.begin;
    for (std::size_t call = 0; call < retelling_.exact_until && !court_.stops(); ++call) do_exactly(call);
    if (court_.stops()) return true;
    go_on();
    while (!court_.stops() && !is_over()) step();
    for (int i = 0; i < kLastRounds && !court_.stops(); ++i) pass(now_ + judging_.round);
    return court_.stops();
  }

 private:
  // ---- as it was recorded ---------------------------------------------------------------------

  void do_exactly(std::size_t number) {
    const CoreCall& call = window_.calls[number];
    ResumedCore& at = *cores_[call.life];
    pass(call.at);
    if (std::holds_alternative<core::Input>(call.what)) {
      apply(call, at, call.at);
    } else if (std::holds_alternative<CoreCall::Begins>(call.what)) {
      begin(at);
    } else if (std::holds_alternative<CoreCall::Ends>(call.what)) {
      end(at);
    } else if (const auto* write = std::get_if<CoreCall::Write>(&call.what)) {
      wire::each_slice(at.core().output(write->line).view(),
                       [&](const wire::Slice& slice) { ++seen_[look_of(at.node(), write->line, slice)]; });
      at.core().output(write->line).clear();
    } else if (std::holds_alternative<CoreCall::TakeEvent>(call.what)) {
      core::Event event;
      at.core().take_event(at.own(call.at), event);
    } else {
      core::ReceivedPacket packet;
      at.core().take(at.own(call.at), packet);
    }
  }

  void pass(Time now) {
    now_ = std::max(now_, now);
    court_.pass(core::whole_nanoseconds(now_.time_since_epoch()));
  }
  void apply(const CoreCall& call, ResumedCore& at, Time now) {
    const auto& what = std::get<core::Input>(call.what);
    note_line(what, at);
    at.core().apply(what, is_untimed(what) ? kNever : at.own(now));
  }
  static bool is_untimed(const core::Input& what) {
    return std::holds_alternative<input::OutputReady>(what) || std::holds_alternative<input::CpuPresent>(what);
  }
  void note_line(const core::Input& what, ResumedCore& at) {
    at.ends.see(what);
    if (const auto* up = std::get_if<input::InputUp>(&what)) ++at.epochs[static_cast<std::size_t>(up->line)];
    if (const auto* lost = std::get_if<input::InputLost>(&what)) ++at.epochs[static_cast<std::size_t>(lost->line)];
  }
  void begin(ResumedCore& at) {
    for (const auto& other : cores_)
      if (other->node() == at.node() && other->alive) end(*other);
    at.alive = true;
    court_.begins(at.node(), at.core(), now_);
  }
  void end(ResumedCore& at) {
    if (!std::exchange(at.alive, false)) return;
    at.wakes = kNever;
    court_.ends(at.node());
  }

  // ---- as a ring of its own -------------------------------------------------------------------

  struct Arrival {
    Time at;
    std::uint64_t order;
    wire::NodeId from, to;
    Line line;
    std::optional<std::uint64_t> epoch;  ///< of the input it goes to; nothing: it was under way when the ring went on
    std::vector<std::uint8_t> bytes;
    wire::SliceKind kind;
    bool operator>(const Arrival& other) const { return at != other.at ? at > other.at : order > other.order; }
  };
  struct Action {
    Time at;
    std::size_t call;
    bool operator<(const Action& other) const { return at != other.at ? at < other.at : call < other.call; }
  };
  void go_on() {
    for (std::size_t event = 0; event < events_.events.size(); ++event)
      if (retelling_.kept[event]) keep(event);
    for (const std::size_t call : events_.background)
      if (call >= retelling_.exact_until) actions_.push_back({window_.calls[call].at, call});
    std::sort(actions_.begin(), actions_.end());
    for (const Departure& left : window_.departures)
      if (left.call < retelling_.exact_until && left.to) put_under_way(left);
    for (const auto& core : cores_) {
      for (const Line line : core->core().lines())
        if (!held_.count({core.get(), line})) core->core().set_output_ready(line, true);
      core->wakes = core->alive ? now_ : kNever;
    }
  }
  void keep(std::size_t number) {
    const RecordedEvent& event = events_.events[number];
    const Duration later = retelling_.later.empty() ? Duration{0} : retelling_.later[number];
    for (const std::size_t call : event.calls) {
      if (call >= retelling_.exact_until) {
        actions_.push_back({window_.calls[call].at + later, call});
      } else if (const auto* output = input_of<input::OutputReady>(window_.calls[call])) {
        if (!output->ready) held_.insert({cores_[window_.calls[call].life].get(), output->line});
      }
    }
    for (const std::size_t lost : event.lost) lost_[window_.departures[lost].look][window_.departures[lost].nth];
    for (const CameInstead& came : event.instead) keep_instead(came);
    if (event.pause) pauses_.push_back(*event.pause);
    if (event.unread) unread_.push_back(*event.unread);
  }
  void keep_instead(const CameInstead& came) {
    const Departure& left = window_.departures[came.departure];
    if (left.call >= retelling_.exact_until) return lost_[left.look][left.nth].push_back(came);
    if (came.call >= retelling_.exact_until) actions_.push_back({window_.calls[came.call].at, came.call});
  }
  // What has left by now and had not come in: it comes when it did.
  void put_under_way(const Departure& left) {
    const bool has_come = left.arrival && *left.arrival < retelling_.exact_until;
    if (has_come || left.lost) return;
    const wire::NodeId from = cores_[window_.calls[left.call].life]->node();
    const Time at = left.arrival ? window_.calls[*left.arrival].at
                                 : window_.calls[left.call].at + window_.transit_of(from, *left.to);
    put(left.slice, from, *left.to, left.line, at, std::nullopt);
  }
  void put(const wire::Slice& slice, wire::NodeId from, wire::NodeId to, Line line, Time at,
           std::optional<std::uint64_t> epoch) {
    Time& last = last_on_[{from, to, line}];  // no slice overtakes another one
    last = std::max({last, at, now_});
    arrivals_.push({last, order_++, from, to, line, epoch, {slice.bytes.begin(), slice.bytes.end()}, slice.kind});
  }

  ResumedCore* living(wire::NodeId node) {
    for (const auto& core : cores_)
      if (core->alive && core->node() == node) return core.get();
    return nullptr;
  }
  bool is_over() const {
    if (action_ < actions_.size() && actions_[action_].at <= retelling_.until) return false;
    const core::Settings& settings = window_.lives.front().settings;
    const Duration least = kLastRounds * Duration(judging_.round) + kLastBeacons * settings.beacon;
    const Duration most = promises::longest_send(settings) + judging_.times.copies_last + least;
    const Time end = std::max(retelling_.until, exact_end());
    return now_ > end + (court_.is_calm() ? least : most);
  }
  Time exact_end() const {
    return retelling_.exact_until == 0 ? window_.begin : window_.calls[retelling_.exact_until - 1].at;
  }

  void step() {
    Time next = arrivals_.empty() ? kNever : arrivals_.top().at;
    if (action_ < actions_.size() && actions_[action_].at <= retelling_.until)
      next = std::min(next, actions_[action_].at);
    for (const auto& core : cores_) next = std::min(next, core->wakes);
    if (next == kNever) next = now_ + judging_.round;
    pass(next);
    touched_.clear();
    for (; action_ < actions_.size() && actions_[action_].at <= now_; ++action_) act(actions_[action_].call);
    while (!arrivals_.empty() && arrivals_.top().at <= now_) deliver();
    for (const auto& core : cores_)
      if (core->wakes <= now_) touched_.insert(core.get());
    for (const auto& core : cores_)
      if (touched_.count(core.get()) != 0) settle(*core);
  }
  void act(std::size_t number) {
    const CoreCall& call = window_.calls[number];
    ResumedCore& at = *cores_[call.life];
    if (std::holds_alternative<CoreCall::Begins>(call.what)) begin(at);
    if (std::holds_alternative<CoreCall::Ends>(call.what)) return end(at);
    if (!at.alive || changes_nothing(call, at)) return;
    if (std::holds_alternative<core::Input>(call.what)) apply(call, at, now_);
    touched_.insert(&at);
  }
  /// A line that goes down, or up, is so already, because what was before it was left out.
  static bool changes_nothing(const CoreCall& call, const ResumedCore& at) {
    const auto* input = std::get_if<core::Input>(&call.what);
    LineEnds after = at.ends;
    return input != nullptr && after.see(*input) && after.is_as(at.ends);
  }
  std::optional<Time> stands_until(const ResumedCore& core, const std::vector<RecordedWindow::Pause>& spans) const {
    for (const RecordedWindow::Pause& span : spans)
      if (cores_[span.life].get() == &core && span.from <= now_ && now_ < span.until) return span.until;
    return std::nullopt;
  }
  void deliver() {
    const Arrival& next = arrivals_.top();
    ResumedCore* const to = living(next.to);
    const auto until = to == nullptr ? std::nullopt : stands_until(*to, pauses_);
    if (until) {
      Arrival later = next;
      later.at = *until;
      arrivals_.pop();
      return arrivals_.push(std::move(later));
    }
    if (to != nullptr && hears(*to, next)) {
      to->core().receive(next.line, {next.kind, {next.bytes.data(), next.bytes.size()}}, to->own(now_));
      touched_.insert(to);
    }
    arrivals_.pop();
  }
  static bool hears(const ResumedCore& core, const Arrival& arrival) {
    const auto line = static_cast<std::size_t>(arrival.line);
    const bool same = !arrival.epoch || *arrival.epoch == core.epochs[line];
    return core.ends.in[line].up && core.ends.in[line].other == arrival.from && same;
  }
  void settle(ResumedCore& core) {
    if (!core.alive) return;
    if (const auto until = stands_until(core, pauses_)) {
      core.wakes = *until;
      return;
    }
    const Time own = core.own(now_);
    bool again = true;
    while (again) {
      core.core().apply(input::Timeout{}, own);
      core.core().apply(input::Run{}, own);
      again = take_all(core, own);
    }
    for (const Line line : core.core().lines()) write(core, line);
    const Time due = core.on_machine(core.core().next_deadline(own));
    const auto reads_at = stands_until(core, unread_);
    core.wakes = std::max(reads_at ? std::min(due, *reads_at) : due, now_);
  }
  /// @return whether there was something
  bool take_all(ResumedCore& core, Time own) {
    bool any = false;
    core::Event event;
    while (core.core().take_event(own, event)) any = true;
    core::ReceivedPacket packet;
    while (!stands_until(core, unread_) && core.core().take(own, packet)) any = true;
    return any;
  }
  void write(ResumedCore& core, Line line) {
    wire::SliceWriter& slices = core.core().output(line);
    const LineEnd& out = core.ends.out[static_cast<std::size_t>(line)];
    wire::each_slice(slices.view(), [&](const wire::Slice& slice) {
      const Look look = look_of(core.node(), line, slice);
      const std::size_t nth = seen_[look]++;
      ResumedCore* const to = out.up ? living(out.other) : nullptr;
      if (to == nullptr) return;
      if (const auto* instead = lost(look, nth)) return put_instead(*instead, slice, core.node());
      put(slice, core.node(), out.other, line, now_ + window_.transit_of(core.node(), out.other),
          to->epochs[static_cast<std::size_t>(line)]);
    });
    slices.clear();
  }

  /// What comes in place of a slice; null: it is not lost.
  const std::vector<CameInstead>* lost(const Look& look, std::size_t nth) const {
    const auto these = lost_.find(look);
    if (these == lost_.end()) return nullptr;
    const auto found = these->second.find(nth);
    return found == these->second.end() ? nullptr : &found->second;
  }
  void put_instead(const std::vector<CameInstead>& all, const wire::Slice& slice, wire::NodeId from) {
    for (const CameInstead& each : all) {
      const Departure& left = window_.departures[each.departure];
      const CoreCall& call = window_.calls[each.call];
      const input::Receive& came = *input_of<input::Receive>(call);
      const Time at = now_ + std::max(call.at - window_.calls[left.call].at, Duration{0});
      arrivals_.push({at, order_++, from, window_.lives[call.life].node, came.line, std::nullopt,
                      changed(slice, left.slice, came.slice), came.slice.kind});
    }
  }
  /// A slice as it comes, changed in the same bits as in the recording: others may differ since, such as its number.
  static std::vector<std::uint8_t> changed(const wire::Slice& now, const wire::Slice& left, const wire::Slice& came) {
    std::vector<std::uint8_t> bytes(came.bytes.begin(), came.bytes.end());
    if (now.bytes.size != bytes.size() || left.bytes.size != bytes.size()) return bytes;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ now.bytes[i] ^ left.bytes[i]);
    return bytes;
  }

  const RecordedWindow& window_;
  const RecordedEvents& events_;
  const Retelling& retelling_;
  Court court_;
  const RecordedJudging& judging_;
  std::vector<std::unique_ptr<ResumedCore>> cores_;  ///< by life
  std::map<Look, std::size_t> seen_;                 ///< how often a slice of that look has left
  Time now_{};
  std::vector<Action> actions_;
  std::size_t action_ = 0;
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<Arrival>> arrivals_;
  std::uint64_t order_ = 0;
  std::map<std::tuple<std::uint8_t, std::uint8_t, Line>, Time> last_on_;
  std::map<Look, std::map<std::size_t, std::vector<CameInstead>>> lost_;  ///< by look and Departure::nth
  std::set<std::pair<ResumedCore*, Line>> held_;
  std::vector<RecordedWindow::Pause> pauses_, unread_;
  std::set<ResumedCore*> touched_;
};

}  // namespace

bool retell(const RecordedWindow& window, const RecordedEvents& events, const Retelling& retelling,
            const RecordedJudging& judging, const std::function<bool(const promises::Breach&)>& breaks) {
  return Teller(window, events, retelling, judging, breaks).tell();
}

}  // namespace limb_ring::sim
