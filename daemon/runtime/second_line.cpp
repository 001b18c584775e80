#include "runtime/second_line.h"

#include <string>

namespace limb_ring::runtime {

SecondLine::SecondLine(boost::asio::io_context& io, const Clock& clock, const LinkSettings::Ends& ends,
                       core::Controller& controller, core::FoldBack::Receiver& receiver, Driver& driver)
    : controller_(controller),
      driver_(driver),
      fold_(controller, receiver, driver.now()),
      input_(io, ends.input, *this),
      output_(io, ends.output, *this),
      faulty_line_(io, clock, output_) {}

void SecondLine::close() {
  input_.close();
  output_.close();
  faulty_line_.close();
}

void SecondLine::write() {
  wire::SliceWriter& line = fold_.second_line();
  if (line.empty()) return;
  faulty_line_.put(line.view(), driver_.now());
  line.clear();
}

void SecondLine::on_slice(const wire::Slice& slice) { fold_.receive_second(slice, driver_.begin_batch()); }

void SecondLine::on_batch_end() { driver_.pump(); }

void SecondLine::on_input_gap(std::uint32_t) { fold_.second_input_gap(driver_.now()); }

void SecondLine::on_input_up(std::uint8_t from) {
  fold_.second_input_up(from);
  driver_.say("second line: input from node " + std::to_string(from));
}

void SecondLine::on_input_lost(std::string_view reason) {
  driver_.say("second line: input lost: " + std::string(reason));
  fold_.second_input_lost(driver_.now());
  driver_.pump();
}

void SecondLine::on_stranger(std::string_view reason) {
  driver_.say("second line: input: turned away: " + std::string(reason));
}

void SecondLine::on_output_up(std::uint8_t to) {
  driver_.say("second line: output to node " + std::to_string(to));
  fold_.second_output_up(driver_.now());
  driver_.pump();
}

void SecondLine::on_output_lost(std::string_view reason) {
  driver_.say("second line: output lost: " + std::string(reason));
  faulty_line_.line_lost();
  fold_.second_output_lost(driver_.now());
  driver_.pump();
}

void SecondLine::on_output_refused(std::uint8_t by, std::string_view reason) {
  driver_.say("second line: output: node " + std::to_string(by) + ": " + std::string(reason));
}

void SecondLine::on_output_ready() {
  if (fold_.turned_back()) controller_.set_output_ready(true);
  driver_.pump();
}

}  // namespace limb_ring::runtime
