#include "model/node.h"

#include <algorithm>
#include <sstream>

namespace limb_ring::model {

namespace input = core::input;

Node::Node(const core::Settings& settings, Time now)
    : settings_(settings), boot_(settings.boot), first_boot_(settings.boot) {
  data_.queues.resize(5);
  interrupts_.interrupt = true;
  interrupts_.queues.resize(1);
  data_.free_since = interrupts_.free_since = now;
  if (settings.fold_back) fold_.emplace(settings_, static_cast<BehindFold&>(*this), given, now);
}

void Node::apply(const core::Input& what, Time now) {
  now_ = now;
  fold_ ? folded_line(what, now) : line(what, now);
  if (const auto* call = std::get_if<input::OutputUp>(&what)) ready_[call->line == Line::second] = true;
  if (const auto* call = std::get_if<input::OutputReady>(&what)) ready_[call->line == Line::second] = call->ready;
  if (const auto* call = std::get_if<input::Send>(&what)) ask(call->request, now);
  if (const auto* call = std::get_if<input::Interrupt>(&what)) ask(call->request, now);
  if (const auto* call = std::get_if<input::Pull>(&what)) pull(call->owner, call->token, call->input, now);
  if (const auto* call = std::get_if<input::Cancel>(&what)) cancel(call->owner, now);
  if (const auto* call = std::get_if<input::CpuReset>(&what)) {  // protocol.md section 5.5
    cancel(call->cpu, now);
    for (auto& buffer : packets) buffer.clear();
  }
  if (const auto* call = std::get_if<input::Cpu>(&what)) {  // protocol.md section 8.2
    const core::CpuReport& report = call->report;
    if (report.boots != cpu_.boots || report.state != cpu_.state || report.stop_latched != cpu_.stop_latched)
      want_beacon();
    cpu_ = report;
    beacons(now);
  }
  if (const auto* call = std::get_if<input::CpuPresent>(&what)) cpu_present_ = call->present;
  if (std::holds_alternative<input::Timeout>(what)) timers(now);
  if (std::holds_alternative<input::Run>(what)) run(now);
}

// ---- lines ------------------------------------------------------------------------------------

void Node::input_up(int from, Time now) {
  input_gap(now);
  input_is_another();
  own_break_ends();
  in_.up = in_.was_up = true;
  in_.neighbour = from;
  watch_for_break(now);
  lines_changed(now);
}

void Node::input_lost(Time now) {
  const bool was_up = in_.up;
  in_.up = false;  // a beacon that follows from a packet that is broken off tells it already
  break_off_input(now);
  if (!was_up) return;
  input_is_another();
  in_.lost_since_home = true;
  lines_changed(now);
  watch_for_break(now);
  new_hello_when_due(now);  // what was broken off may have ended what was out
}

void Node::input_is_another() {
  for (auto& [source, page] : pages_)
    for (auto& [kind, decided] : page.decided) decided.on_former_input = true;
}

void Node::input_gap(Time now) {
  break_off_input(now);
  new_hello_when_due(now);
}

void Node::output_up(int to, Time now) {
  drop_output(now);
  out_.up = out_.was_up = true;
  out_.neighbour = to;
  watch_for_break(now);
  lines_changed(now);
}

void Node::output_lost(Time now) {
  if (!out_.up) return;
  drop_output(now);
  out_.up = false;
  out_.lost_since_home = true;
  lines_changed(now);
}

// ---- time -------------------------------------------------------------------------------------

void Node::timers(Time now) {
  if (fold_) fold_->timers(now);
  if (incoming_ && incoming_->heard + settings_.stall + 2048 * settings_.byte_time_in <= now) break_off_input(now);
  unit_timers(data_, now);
  unit_timers(interrupts_, now);
  membership_timers(now);
}

void Node::run(Time now) {
  if (fold_) fold_->run(now);
  step(now);
  if (fold_) fold_->carry(now);
}

Time Node::next_deadline(Time now) const {
  Time next = std::min({unit_deadline(data_), unit_deadline(interrupts_), membership_deadline(), next_step(now).at});
  if (incoming_) next = std::min(next, incoming_->heard + settings_.stall + 2048 * settings_.byte_time_in);
  if (fold_) next = std::min(next, fold_->next_deadline());
  for (const core::Event& event : events) next = std::min(next, event.at);
  return next;
}

void Node::tell(Time at, decltype(core::Event::what) what) { events.push_back({at, std::move(what)}); }

core::ReceivedPacket* Node::next_packet(Time now) {
  for (auto& buffer : packets)
    if (!buffer.empty() && buffer.front().at <= now) return &buffer.front();
  return nullptr;
}

// ---- the configured ring ----------------------------------------------------------------------

unsigned Node::distance(int from, int to) const {
  unsigned place_from = 0, place_to = 0;
  for (unsigned i = 0; i < count_nodes(); ++i) {
    if (settings_.order[i] == from) place_from = i;
    if (settings_.order[i] == to) place_to = i;
  }
  return (place_to + count_nodes() - place_from) % count_nodes();
}

bool Node::configured(int id) const {
  return std::any_of(settings_.order.begin(), settings_.order.end(), [&](int known) { return known == id; });
}

// protocol.md section 7.3. The slowest line and the sum of all delays are known to who makes the settings, where lines
// differ.
Duration Node::worst_lap() const {
  if (settings_.lap.count() != 0) return settings_.lap;
  return count_nodes() * (settings_.byte_time_out * (524 + 12) + settings_.relay_delay);
}

Duration Node::try_timeout() const {
  Duration second{0};
  if (settings_.fold_back)
    second = settings_.all_delays.count() != 0 ? settings_.all_delays : count_nodes() * settings_.relay_delay;
  return std::max(settings_.send_timeout_least, 2 * (worst_lap() + second));
}

std::string Node::in_words() const {
  std::ostringstream text;
  const auto ps = [](Time at) { return picoseconds(at.time_since_epoch()); };
  text << "state " << to_string(state_) << ", boot " << boot_ << ", ring size " << ring_size_
       << (in_.lost_since_home ? ", input was lost" : "") << (out_.lost_since_home ? ", output was lost" : "")
       << (in_.up ? "" : ", input down") << (out_.up ? "" : ", output down") << (hello_out_ ? ", hello out" : "")
       << (beacon_out_ ? ", beacon out" : "") << (new_hello_wanted_ ? ", new hello wanted" : "") << ", beacon at "
       << ps(beacon_at_) << ", hello said at " << ps(hello_said_) << ", again at " << ps(hello_due_) << ", break at "
       << ps(break_at_) << ", drained at " << ps(drained_at_) << "; relayed waiting " << relayed_.size() << " + "
       << relayed_interrupts_.size() << (outgoing_ ? ", one going out" : "");
  for (const Unit* unit : {&data_, &interrupts_}) {
    text << "; " << (unit->interrupt ? "INTPs" : "DATPs") << " free since " << ps(unit->free_since);
    if (unit->flight)
      text << ", out: token " << unit->flight->send.token << " to " << unit->flight->send.destination << " number "
           << unit->flight->sequence << " try " << unit->flight->attempt << " left " << ps(unit->flight->left)
           << (unit->flight->waits_since ? " waits for its retry" : "");
    for (const auto& queue : unit->queues)
      for (const Send& send : queue)
        text << ", token " << send.token << " to " << send.destination << " PRI " << send.last << " due "
             << ps(send.due);
  }
  if (fold_) text << "; fold: " << fold_->in_words();
  return text.str();
}

}  // namespace limb_ring::model
