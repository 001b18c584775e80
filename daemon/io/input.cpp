#include "io/input.h"

#include <algorithm>

#include "io/udp_input.h"
#include "io/unix_input.h"

namespace limb_ring::link {
namespace {

template <typename Line>
std::shared_ptr<InputLine> opened(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler,
                                  InputReport& report, Upstream& upstream) {
  auto line = std::make_shared<Line>(io, settings, handler, report, upstream);
  line->start();
  return line;
}

}  // namespace

// UDP first: if its address is not this machine's, it throws before anything else is opened.
Input::Input(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler) {
  if (settings.delay.count() > 0) {
    delay_ = std::make_unique<DelayedInput>(io, settings.delay, handler, report_.counters);
  }
  InputHandler& next = delay_ ? *delay_ : handler;
  if (settings.from_hosts) open(io, settings, *settings.from_hosts, next);
  open(io, settings, settings.endpoint, next);
}

void Input::open(boost::asio::io_context& io, InputSettings settings, const Endpoint& endpoint, InputHandler& handler) {
  settings.endpoint = endpoint;
  const bool udp = endpoint.transport == Endpoint::Transport::udp;
  lines_.push_back(udp ? opened<UdpInput>(io, settings, handler, report_, upstream_)
                       : opened<UnixInput>(io, settings, handler, report_, upstream_));
}

bool Input::is_in_place() const {
  return std::all_of(lines_.begin(), lines_.end(), [](const auto& line) { return line->is_in_place(); });
}

void Input::close() {
  for (const auto& line : lines_) line->close();
  if (delay_) delay_->close();
}

}  // namespace limb_ring::link
