#include "link/input.h"

#include "link/udp_input.h"
#include "link/unix_input.h"

namespace limb_ring::link {
namespace {

template <typename Line>
std::shared_ptr<InputLine> open(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler,
                                InputReport& report) {
  auto line = std::make_shared<Line>(io, settings, handler, report);
  line->start();
  return line;
}

}  // namespace

Input::Input(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler) {
  if (settings.delay.count() > 0) {
    delay_ = std::make_unique<DelayedInput>(io, settings.delay, handler, report_.counters);
  }
  InputHandler& next = delay_ ? *delay_ : handler;
  const bool udp = settings.endpoint.transport == Endpoint::Transport::udp;
  line_ = udp ? open<UdpInput>(io, settings, next, report_) : open<UnixInput>(io, settings, next, report_);
}

void Input::close() {
  line_->close();
  if (delay_) delay_->close();
}

}  // namespace limb_ring::link
