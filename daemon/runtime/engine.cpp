#include "runtime/engine.h"

#include <algorithm>
#include <string>

namespace limb_ring::runtime {

Engine::Engine(boost::asio::io_context& io, const core::Settings& core, const LinkSettings& links,
               EngineListener& listener)
    : listener_(listener),
      controller_(core),
      timer_(io),
      silence_(links.first.input.timing.silence),
      input_(io, links.first.input, *this),
      output_(io, links.first.output, *this),
      faulty_line_(io, clock_, output_) {
  if (!links.second) return;
  core::FoldBack::Receiver& receiver = *this;
  SecondLine::Driver& driver = *this;
  second_.emplace(io, clock_, *links.second, controller_, receiver, driver);
}

void Engine::close() {
  closed_ = true;
  input_.close();
  output_.close();
  faulty_line_.close();
  if (second_) second_->close();
  timer_.cancel();
}

void Engine::listen_again() {
  input_.listen_again();
  if (second_) second_->listen_again();
}

void Engine::on_slice(const wire::Slice& slice) {
  begin_batch();
  second_ ? second_->fold().receive(slice, at_) : take(slice, at_);
}

void Engine::take(const wire::Slice& slice, core::Time now) {
  if (tap_ != nullptr) {
    const link::Input& line = second_ && second_->fold().takes_second() ? second_->input() : input_;
    tap_->on_input(slice, line.from().value_or(wire::kBroadcast), clock_.steady(now));
  }
  controller_.receive(slice, now);
}

core::Time Engine::begin_batch() {
  if (!in_batch_) at_ = clock_.now();
  in_batch_ = true;
  return at_;
}

void Engine::on_batch_end() { pump(); }

void Engine::on_input_gap(std::uint32_t) {
  if (tap_ != nullptr) tap_->on_input_gap(clock_.steady(now()));
  second_ ? second_->fold().input_gap(now()) : controller_.input_gap(now());
}

void Engine::on_input_up(std::uint8_t from) {
  listener_.on_link("input from node " + std::to_string(from));
  second_ ? second_->fold().input_up(from, now()) : controller_.input_up(from, now());
  pump();
}

void Engine::on_input_lost(std::string_view reason) {
  listener_.on_link("input lost: " + std::string(reason));
  if (tap_ != nullptr) tap_->on_input_gap(clock_.steady(now()));
  input_lost_at_ = now() - (reason == link::kSilent ? silence_ : core::Duration{0});
  second_ ? second_->fold().input_lost(now()) : controller_.input_lost(now());
  pump();
}

void Engine::on_stranger(std::string_view reason) { listener_.on_link("input: turned away: " + std::string(reason)); }

void Engine::on_output_up(std::uint8_t to) {
  listener_.on_link("output to node " + std::to_string(to));
  second_ ? second_->fold().output_up(to, now()) : controller_.output_up(to, now());
  pump();
}

void Engine::on_output_lost(std::string_view reason) {
  listener_.on_link("output lost: " + std::string(reason));
  if (tap_ != nullptr) tap_->on_output_gap(clock_.steady(now()));
  faulty_line_.line_lost();
  second_ ? second_->fold().output_lost(now()) : controller_.output_lost(now());
  pump();
}

void Engine::on_output_refused(std::uint8_t by, std::string_view reason) {
  listener_.on_link("output: node " + std::to_string(by) + ": " + std::string(reason));
}

void Engine::on_output_ready() {
  if (!second_ || !second_->fold().turned_back()) controller_.set_output_ready(true);
  pump();
}

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

void Engine::round() {
  again_ = false;
  if (deadline_ <= at_) {
    controller_.handle_timeout(at_);
    if (second_) second_->fold().handle_timeout(at_);
  }
  controller_.run(at_);
  core::Event event;
  while (controller_.take_event(at_, event)) {
    listener_.on_event(event);
    again_ = true;
  }
  // One write for what passes and for what the listener asks for: written apart, an own packet
  // would lag behind the others for ever, and every node would be woken for it alone.
  if (!again_) write_line();
  listener_.on_round_end();
  deadline_ = controller_.next_deadline(at_);
  if (second_) deadline_ = std::min(deadline_, second_->fold().deadline());
}

void Engine::show_output() {
  if (tap_ == nullptr || controller_.line().empty()) return;
  const link::Output& line = second_ && second_->fold().turned_back() ? second_->output() : output_;
  if (line.up()) tap_->on_output(controller_.line().view(), line.to(), clock_.steady(at_));
}

void Engine::write_line() {
  show_output();
  if (!second_) return write(controller_.line());
  core::FoldBack& fold = second_->fold();
  fold.carry(at_);
  write(fold.line());
  second_->write();
  controller_.set_output_ready((fold.turned_back() ? second_->output() : output_).ready());
}

void Engine::write(wire::SliceWriter& line) {
  if (line.empty()) return;
  faulty_line_.put(line.view(), at_);
  line.clear();
  if (!second_) controller_.set_output_ready(output_.ready());
}

// A timer that fires too early costs less than setting it anew for every packet.
void Engine::arm_timer() {
  if (deadline_ >= armed_for_) return;
  armed_for_ = deadline_;
  timer_.expires_at(clock_.steady(deadline_));
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    armed_for_ = core::kNever;
    pump();
  });
}

}  // namespace limb_ring::runtime
