#include "node/engine.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>
#include <utility>

#include "wire/slice.h"

namespace limb_ring::runtime {

NodeLine::NodeLine(boost::asio::io_context& io, const Clock& clock, const setup::LinkSettings& links,
                   LineHandler& handler)
    : line_(links.line),
      handler_(handler),
      input_(io, links.input, *this),
      output_(io, links.output, *this),
      faulty_line_(io, clock, output_) {}

void NodeLine::write(wire::SliceWriter& slices, core::Time now) {
  if (slices.empty()) return;
  faulty_line_.put(slices.view(), now);
  slices.clear();
}

void NodeLine::close() {
  input_.close();
  output_.close();
  faulty_line_.close();
}

void NodeLine::on_output_lost(std::string_view reason) {
  faulty_line_.line_lost();
  handler_.on_output_lost(line_, reason);
}

// The seed 0 has no effect: every fault with random damage brings its own seed.
FaultyLine::FaultyLine(boost::asio::io_context& io, const Clock& clock, link::Output& output)
    : clock_(clock), output_(output), faults_(0), timer_(io, [this] { update(clock_.now()); }) {}

fault::LineFaults::Id FaultyLine::begin(const fault::Fault& fault, core::Time now) {
  const auto id = faults_.begin(fault, now);
  update(now);
  return id;
}

bool FaultyLine::remove(fault::LineFaults::Id id, core::Time now) {
  const bool removed = faults_.remove(id);
  update(now);
  return removed;
}

void FaultyLine::clear(core::Time now) {
  faults_.clear();
  update(now);
}

void FaultyLine::pass_all(wire::ByteView framed_slices, core::Time now) {
  wire::each_slice(framed_slices, [&](const wire::Slice& slice) { pass(slice, now); });
  update(now);
}

// A reordered datagram is sent after the next one but keeps its own sequence number, so the receiver discards it. The
// faults therefore treat it as lost: they put only the other slices onto the line. Slices that come before the late
// datagram are written first, so that they get the lower sequence numbers.
void FaultyLine::pass(const wire::Slice& slice, core::Time now) {
  const auto late = faults_.counters().line_reordered;
  faults_.pass(slice, now);
  const bool in_one_piece = slice.kind == wire::SliceKind::whole || slice.kind == wire::SliceKind::interrupt;
  if (faults_.counters().line_reordered == late || !in_one_piece) return;
  wire::SliceWriter one;
  one.put(slice.kind, slice.bytes);
  write_due(now);
  output_.write_late(one.view());
}

void FaultyLine::update(core::Time now) {
  using link::Wire;
  wire_ = faults_.cut(now) ? Wire::cut : faults_.stalled(now) ? Wire::held : Wire::whole;
  output_.set_wire(wire_);
  write_due(now);
  active_ = !faults_.idle();
  arm_timer();
}

void FaultyLine::write_due(core::Time now) {
  faults_.take(now, due_);
  if (!due_.empty()) output_.write(due_.view());
  due_.clear();
}

void FaultyLine::arm_timer() {
  const core::Time due = faults_.next_deadline();
  if (due == core::kNever) return;
  timer_.expires_at(clock_.steady(due));
}

namespace {

constexpr std::chrono::milliseconds kPutOffEvery{10};

}  // namespace

Engine::Engine(boost::asio::io_context& io, const core::Settings& core, const std::vector<setup::LinkSettings>& lines,
               DriverListener& listener)
    : machine_clock_(io),
      listener_(listener),
      controller_(core, clock_.now()),
      loop_(event_loop::PacketLoop::of(io)),
      timer_(io,
             [this] {
               armed_for_ = core::kNever;
               pump();
             }),
      silence_(lines.front().input.timing.silence) {
  LineHandler& handler = *this;
  for (const setup::LinkSettings& links : lines) lines_.emplace_back(io, clock_, links, handler);
}

void Engine::close() {
  closed_ = true;
  for (NodeLine& line : lines_) line.close();
  timer_.cancel();
}

bool Engine::is_in_place() const {
  if (!recording_is_in_place()) return false;
  return std::all_of(lines_.begin(), lines_.end(), [](const NodeLine& line) { return line.input().is_in_place(); });
}

void Engine::listen_again() {
  for (NodeLine& line : lines_)
    if (!line.input().is_in_place()) line.listen_again();
  if (!recording_is_in_place()) record_again_();
}

bool Engine::recording_is_in_place() const {
  return !record_again_ || (recorder_ != nullptr && recorder_->is_in_place());
}

void Engine::record(const std::string& path, std::size_t size, recorder::Title title) {
  using std::chrono::nanoseconds;
  using std::chrono::system_clock;
  const core::Time now = clock_.now();
  const auto in_ns = [](auto span) { return std::chrono::duration_cast<nanoseconds>(span).count(); };
  title.zero = in_ns(clock_.steady(core::Time{}).time_since_epoch());
  title.date = in_ns(system_clock::now().time_since_epoch()) - core::whole_nanoseconds(now.time_since_epoch()).count();
  title.settings = controller_.settings();
  recorder_ = std::make_unique<recorder::RecorderFile>(path, size, controller_, title, now, [this] {
    spdlog::warn("recorder: the state of the node no longer fits; enlarge recorder.size");
  });
  recorder_->set_next(journal_);
  record_again_ = [this, path, size, title] {
    recorder_.reset();
    ::unlink(path.c_str());  // cut off, so that it is not kept as that of the former life
    record(path, size, title);
  };
}

// The flight recorder is the journal, and passes on what it sees.
void Engine::set_journal(core::Journal* journal) {
  journal_ = journal;
  if (recorder_ != nullptr) return recorder_->set_next(journal);
  controller_.set_journal(journal);
}

void Engine::set_tap(LineTap* tap) {
  tap_ = tap;
  controller_.set_tap(tap != nullptr ? this : nullptr);
}

LineEnds Engine::ends(core::Line on) const {
  const NodeLine& line = this->line(on);
  LineEnds ends;
  ends.from = line.input().from();
  if (line.output().up()) ends.to = line.output().to();
  return ends;
}

// ---- from the lines -----------------------------------------------------------------------

void Engine::tell_lost(core::Line line, bool input, std::string_view reason) {
  const LinkChange change{line, input, LinkChange::Is::lost, {}, std::string(reason)};
  last_loss_ = change.words();
  listener_.on_link(change);
}

void Engine::on_slice(core::Line line, const wire::Slice& slice) {
  if (!in_batch_) at_ = clock_.now();
  in_batch_ = true;
  controller_.receive(line, slice, at_);
}

void Engine::on_input_gap(core::Line line) {
  if (tap_ != nullptr) tap_->on_input_gap(clock_.steady(now()));
  controller_.apply(core::input::InputGap{line}, now());
}

void Engine::on_input_up(core::Line line, wire::NodeId from) {
  listener_.on_link({line, true, LinkChange::Is::up, from});
  controller_.apply(core::input::InputUp{line, from}, now());
  pump();
}

void Engine::on_input_lost(core::Line line, std::string_view reason) {
  tell_lost(line, true, reason);
  if (tap_ != nullptr) tap_->on_input_gap(clock_.steady(now()));
  if (line == core::Line::first) input_lost_at_ = now() - (reason == link::kSilent ? silence_ : core::Duration{0});
  controller_.apply(core::input::InputLost{line}, now());
  pump();
}

void Engine::on_output_up(core::Line line, wire::NodeId to) {
  listener_.on_link({line, false, LinkChange::Is::up, to});
  controller_.apply(core::input::OutputUp{line, to}, now());
  pump();
}

void Engine::on_output_lost(core::Line line, std::string_view reason) {
  tell_lost(line, false, reason);
  if (tap_ != nullptr) tap_->on_output_gap(clock_.steady(now()));
  controller_.apply(core::input::OutputLost{line}, now());
  pump();
}

void Engine::on_output_ready(core::Line line) {
  controller_.set_output_ready(line, true);
  pump();
}

void Engine::on_unknown_peer(core::Line line, std::string_view reason) {
  listener_.on_link({line, true, LinkChange::Is::refused, {}, std::string(reason)});
}

void Engine::on_output_refused(core::Line line, wire::NodeId by, std::string_view reason) {
  listener_.on_link({line, false, LinkChange::Is::refused, by, std::string(reason)});
}

// ---- what a tap sees ----------------------------------------------------------------------

void Engine::arrives(const wire::Slice& slice, core::Line on, core::Time now) {
  tap_->on_input(slice, wire::NodeId{line(on).input().from().value_or(wire::kBroadcast)}, clock_.steady(now));
}

void Engine::leaves(wire::ByteView framed_slices, core::Line on, core::Time now) {
  const link::Output& output = line(on).output();
  if (output.up()) tap_->on_output(framed_slices, wire::NodeId{output.to()}, clock_.steady(now));
}

// ---- rounds -------------------------------------------------------------------------------

void Engine::pump() {
  again_ = true;
  if (pumping_ || closed_) return;
  if (!in_batch_) at_ = clock_.now();
  in_batch_ = false;
  pumping_ = true;
  while (again_ && !closed_) round();
  pumping_ = false;
  if (!closed_) arm_timer();
}

void Engine::pump_soon() {
  if (std::exchange(pump_asked_, true)) return;
  loop_.at_turn_end([this] {
    pump_asked_ = false;
    pump();
  });
}

// In a batch the time stands still.
void Engine::pump_around(const std::function<void(core::Time now)>& call) {
  pump();
  in_batch_ = true;
  call(at_);
  pump();
}

void Engine::round() {
  again_ = false;
  if (deadline_ <= at_) controller_.apply(core::input::Timeout{}, at_);
  controller_.apply(core::input::Run{}, at_);
  core::Event event;
  while (controller_.take_event(at_, event)) {
    note(event);
    listener_.on_event(event);
    again_ = true;
  }
  // One write for what passes and for what the listener asks for: written apart, an own packet
  // would lag behind the others for ever, and every node would be woken for it alone.
  if (!again_) write_lines();
  listener_.on_round_end();
  deadline_ = controller_.next_deadline(at_);
}

void Engine::note(const core::Event& event) {
  const auto* change = std::get_if<core::StateChanged>(&event.what);
  if (change == nullptr) return;
  const bool broken = change->after == core::NodeState::open_chain || change->after == core::NodeState::folded;
  if (broken) broken_since_ = at_;
}

void Engine::write_lines() {
  for (NodeLine& line : lines_) {
    wire::SliceWriter& slices = controller_.output(line.line());
    if (slices.empty()) continue;
    line.write(slices, at_);
    controller_.set_output_ready(line.line(), line.output().ready());
  }
}

// Setting the timer later for every packet that passes costs more than letting it fire too early; but a quiet node that
// wakes for nothing costs more than setting it.
void Engine::arm_timer() {
  const bool may_put_off = deadline_ != core::kNever && (at_ >= may_put_off_at_ || !loop_.packets_pass());
  if (deadline_ == armed_for_ || (deadline_ > armed_for_ && !may_put_off)) return;
  armed_for_ = deadline_;
  may_put_off_at_ = at_ + kPutOffEvery;
  timer_.expires_at(clock_.steady(deadline_));
}

}  // namespace limb_ring::runtime
