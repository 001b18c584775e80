#include "link/delayed_input.h"

#include <deque>
#include <string>

#include "event_loop/packet_timer.h"

namespace limb_ring::link {

/// May outlive the DelayedInput, for the rest of a call.
struct DelayedInput::Line : std::enable_shared_from_this<Line> {
  Line(boost::asio::io_context& io, InputHandler& to) : timer(io, [this] { on_time(); }), next(&to) {}

  void wait() {
    waiting = true;
    timer.expires_at(events.front().due);
  }

  void on_time() {
    const auto self = shared_from_this();  // the handler may close the input
    waiting = false;
    if (next != nullptr) deliver(Clock::now());
    if (next != nullptr && !events.empty()) wait();
  }

  void deliver(Time now) {
    while (next != nullptr && !events.empty() && events.front().due <= now) {
      const Event event = std::move(events.front());
      events.pop_front();
      size -= event.size;
      event.deliver(*next);
    }
  }

  event_loop::PacketTimer timer;
  InputHandler* next;
  std::deque<Event> events;
  std::size_t size = 0;
  bool waiting = false;
};

DelayedInput::DelayedInput(boost::asio::io_context& io, nanoseconds delay, InputHandler& next, InputCounters& counters)
    : delay_(delay), counters_(counters), line_(std::make_shared<Line>(io, next)) {}

void DelayedInput::close() {
  line_->next = nullptr;
  line_->timer.cancel();
}

void DelayedInput::on_slice(const wire::Slice& slice) {
  const std::size_t size = wire::kMaxSliceSize;
  if (line_->size + size > kLimit) {
    ++counters_.delay_dropped;
    return on_input_gap(1);
  }
  std::vector<std::uint8_t> bytes(slice.bytes.begin(), slice.bytes.end());
  add(size, [kind = slice.kind, bytes = std::move(bytes)](InputHandler& next) {
    next.on_slice({kind, {bytes.data(), bytes.size()}});
  });
}

void DelayedInput::on_batch_end() {
  add(0, [](InputHandler& next) { next.on_batch_end(); });
}

void DelayedInput::on_input_gap(std::uint32_t lost) {
  add(0, [lost](InputHandler& next) { next.on_input_gap(lost); });
}

void DelayedInput::on_input_up(std::uint8_t from) {
  add(0, [from](InputHandler& next) { next.on_input_up(from); });
}

void DelayedInput::on_input_lost(std::string_view reason) {
  add(0, [reason = std::string(reason)](InputHandler& next) { next.on_input_lost(reason); });
}

void DelayedInput::on_unknown_peer(std::string_view reason) {
  add(0, [reason = std::string(reason)](InputHandler& next) { next.on_unknown_peer(reason); });
}

void DelayedInput::add(std::size_t size, std::function<void(InputHandler&)> deliver) {
  line_->events.push_back({Clock::now() + delay_, size, std::move(deliver)});
  line_->size += size;
  if (!line_->waiting) line_->wait();
}

}  // namespace limb_ring::link
