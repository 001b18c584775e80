#include "io/input.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <deque>
#include <string>

#include "io/admission.h"
#include "io/packet_loop.h"
#include "io/udp_line.h"
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

void InputReport::turned_away(const std::string& who, const LinkHeader& connect, const LinkHeader& refuse,
                              InputHandler& handler) {
  if (refuse.refusal == Refusal::busy) {
    ++counters.refused;
    return;
  }
  count(refuse.refusal, counters);
  const std::string why = why_unfit(connect, refuse);
  refusals.note(connect.sender, why);
  unknown_peer(who + ": " + why);
  if (report_once(last_unknown_peer)) handler.on_unknown_peer(last_unknown_peer);
}

void InputReport::came_up(std::uint8_t from) {
  ++counters.connects;
  refusals.forget(from);
  report_once.forget();
}

bool SliceFeed::commit(std::size_t size, InputHandler& handler, InputCounters& counters) {
  using Status = wire::SliceParse::Status;
  wire::ByteView rest{buffer_.data(), kept_ + size};
  const std::uint64_t before = counters.slices;
  bool well_formed = true;
  for (;;) {
    const wire::SliceParse parse = wire::parse_slice(rest);  // a copy of it would take longer than all else here
    well_formed = parse.status != Status::malformed;
    if (parse.status != Status::slice) break;
    rest = rest.from(parse.consumed);
    if (parse.slice.kind == wire::SliceKind::idle) {
      ++counters.idle_slices;
      continue;
    }
    ++counters.slices;
    handler.on_slice(parse.slice);
    if (stopped_) return true;
  }
  kept_ = rest.size;
  if (kept_ != 0) std::memmove(buffer_.data(), rest.data, kept_);
  if (counters.slices != before) handler.on_batch_end();
  return well_formed;
}

void Silence::restart(Time now) {
  last_tick_ = now;
  quiet_ = Clock::duration::zero();
  heard_ = true;
}

bool Silence::tick(Time now) {
  const auto passed = std::min<Clock::duration>(now - last_tick_, 2 * timing_.idle);
  last_tick_ = now;
  quiet_ = heard_ ? Clock::duration::zero() : quiet_ + passed;
  heard_ = false;
  return quiet_ >= timing_.silence;
}

namespace {

nanoseconds read_clock(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + nanoseconds(now.tv_nsec);
}

}  // namespace

bool Suspension::noticed() {
  if (!asks_) return false;
  const nanoseconds boot = read_clock(CLOCK_BOOTTIME);
  return noticed(boot, read_clock(CLOCK_MONOTONIC));
}

bool Suspension::noticed(nanoseconds boot, nanoseconds monotonic) {
  if (!asks_) return false;
  const nanoseconds slept = boot - monotonic;
  const bool grew = slept_ && slept - *slept_ >= least_;
  slept_ = std::max(slept, slept_.value_or(slept));
  return grew;
}

}  // namespace limb_ring::link
