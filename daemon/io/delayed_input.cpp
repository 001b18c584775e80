#include "io/delayed_input.h"

#include <deque>
#include <string>

#include "io/packet_timer.h"

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
      if (event.kind == Event::Kind::gap)
        next->on_input_gap();
      else
        event.deliver(*next);
    }
  }

  bool ends_with_batch() const { return !events.empty() && events.back().kind == Event::Kind::batch_end; }

  bool ends_with_gap() const {
    const auto last = events.rbegin() + (ends_with_batch() ? 1 : 0);
    return last != events.rend() && last->kind == Event::Kind::gap;
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
  const std::size_t size = wire::kSliceHeaderSize + slice.bytes.size;
  if (line_->size + size > kLimit) {
    ++counters_.delay_dropped;
    return on_input_gap();
  }
  std::vector<std::uint8_t> bytes(slice.bytes.begin(), slice.bytes.end());
  add({Event::Kind::other, size, [kind = slice.kind, bytes = std::move(bytes)](InputHandler& next) {
         next.on_slice({kind, {bytes.data(), bytes.size()}});
       }});
}

void DelayedInput::on_batch_end() {
  if (line_->ends_with_batch()) return;
  add({Event::Kind::batch_end, 0, [](InputHandler& next) { next.on_batch_end(); }});
}

// One for all that is lost before the next slice: a line that is full would else hold ever more of them.
void DelayedInput::on_input_gap() {
  if (!line_->ends_with_gap()) add({Event::Kind::gap, 0, {}});
}

void DelayedInput::on_input_up(std::uint8_t from) {
  add({Event::Kind::other, 0, [from](InputHandler& next) { next.on_input_up(from); }});
}

void DelayedInput::on_input_lost(std::string_view reason) {
  add({Event::Kind::other, 0, [reason = std::string(reason)](InputHandler& next) { next.on_input_lost(reason); }});
}

void DelayedInput::on_unknown_peer(std::string_view reason) {
  add({Event::Kind::other, 0, [reason = std::string(reason)](InputHandler& next) { next.on_unknown_peer(reason); }});
}

void DelayedInput::add(Event event) {
  event.due = Clock::now() + delay_;
  line_->size += event.size;
  line_->events.push_back(std::move(event));
  if (!line_->waiting) line_->wait();
}

}  // namespace limb_ring::link
