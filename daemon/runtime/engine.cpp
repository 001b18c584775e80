#include "runtime/engine.h"

#include <string>

namespace limb_ring::runtime {

Engine::Engine(boost::asio::io_context& io, const core::Settings& core, const link::InputSettings& input,
               const link::OutputSettings& output, EngineListener& listener)
    : listener_(listener),
      controller_(core),
      timer_(io),
      input_(io, input, *this),
      output_(io, output, *this) {}

void Engine::close() {
  closed_ = true;
  input_.close();
  output_.close();
  timer_.cancel();
}

void Engine::on_slice(const wire::Slice& slice) {
  if (!in_batch_) at_ = clock_.now();
  in_batch_ = true;
  if (tap_ != nullptr) tap_->on_input(slice, input_.from().value_or(wire::kBroadcast), clock_.steady(at_));
  controller_.receive(slice, at_);
}

void Engine::on_batch_end() { pump(); }

void Engine::on_input_gap(std::uint32_t) {
  if (tap_ != nullptr) tap_->on_input_gap(clock_.steady(now()));
  controller_.input_gap(now());
}

void Engine::on_input_up(std::uint8_t from) {
  listener_.on_link("input from node " + std::to_string(from));
  controller_.input_up(from, now());
  pump();
}

void Engine::on_input_lost(std::string_view reason) {
  listener_.on_link("input lost: " + std::string(reason));
  if (tap_ != nullptr) tap_->on_input_gap(clock_.steady(now()));
  controller_.input_lost(now());
  pump();
}

void Engine::on_output_up(std::uint8_t to) {
  listener_.on_link("output to node " + std::to_string(to));
  controller_.output_up(to, now());
  pump();
}

void Engine::on_output_lost(std::string_view reason) {
  listener_.on_link("output lost: " + std::string(reason));
  if (tap_ != nullptr) tap_->on_output_gap(clock_.steady(now()));
  controller_.output_lost(now());
  pump();
}

void Engine::on_output_ready() {
  controller_.set_output_ready(true);
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
  if (deadline_ <= at_) controller_.handle_timeout(at_);
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
}

void Engine::write_line() {
  wire::SliceWriter& line = controller_.line();
  if (line.empty()) return;
  if (tap_ != nullptr && output_.up()) tap_->on_output(line.view(), output_.to(), clock_.steady(at_));
  output_.write(line.view());
  line.clear();
  controller_.set_output_ready(output_.ready());
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
