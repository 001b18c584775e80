#include "node/node_line.h"

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

}  // namespace limb_ring::runtime
