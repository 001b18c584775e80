#include "judge/flight_recorder.h"

#include <cstring>
#include <new>

namespace limb_ring::recorder {

std::uint64_t state_layout() {
  static const std::uint64_t layout = [] {
    core::Settings settings;
    settings.fold_back = true;
    core::NetworkController controller(settings, core::Time{});
    core::StateLayout members;
    controller.archive(members);
    return members.value();
  }();
  return layout;
}

FlightRecorder::FlightRecorder(core::NetworkController& controller, std::uint8_t* memory, std::size_t size, Title title,
                               core::Time now, std::function<void()> on_too_small)
    : controller_(controller),
      halves_(memory + kTitleSize),
      half_((size - kTitleSize) / 2 & ~std::size_t{7}),
      head_(reinterpret_cast<HalfHead*>(halves_)),
      records_(core::StateWriter(halves_, 0), now),
      ahead_(halves_),
      on_too_small_(std::move(on_too_small)) {
  title.layout = state_layout();
  title.program = LIMB_RING_VERSION;
  title.half = half_;
  core::StateWriter writer(memory + kMagic.size(), kTitleSize - kMagic.size());
  title.archive(writer);
  std::memcpy(memory, kMagic.data(), kMagic.size());
  controller.set_journal(this);
  begin_half();
}

bool FlightRecorder::half_is_over() const {
  if (records_.failed() || records_.left() < kMargin) return true;
  return records_.left_out() && records_.left() < kSoon && !controller_.holds_packets();
}

// The half has generation 0 until its state is written, so a process that is killed meanwhile leaves the other half
// valid. If the previous half ended early, the generation skips one number: the halves do not follow each other. So it
// does if the state holds packets, and data was left out: a replay of the previous half does not come to that state.
void FlightRecorder::begin_half() {
  const bool follows = !records_.failed() && !(records_.left_out() && controller_.holds_packets());
  generation_ += follows ? 1 : 2;
  const bool in_first = reinterpret_cast<std::uint8_t*>(head_) == halves_;
  std::uint8_t* const half = halves_ + (in_first ? half_ : 0);
  head_ = new (half) HalfHead{};
  head_->generation.store(0, std::memory_order_release);
  core::StateWriter room(half + sizeof(HalfHead), half_ - sizeof(HalfHead));
  core::Time last = records_.last();
  room("time", last);
  controller_.archive(room);
  if (room.failed() || room.left() < kMargin) return stop();
  records_ = RecordWriter(room, last);
  ahead_ = LinesAhead(room.next());
  head_->used.store(room.size(), std::memory_order_release);
  head_->generation.store(generation_, std::memory_order_release);
}

void FlightRecorder::stop() {
  stopped_ = true;
  controller_.set_journal(next_);
  on_too_small_();
}

void FlightRecorder::show() {
  if (records_.failed()) return;
  head_->used.store(records_.size(), std::memory_order_release);
  ahead_.fetch(records_.next(), records_.left());
}

// Only an input may begin a half: before it, the state is exactly the result of all records so far. Between the
// outputs of one input it is not.
void FlightRecorder::goes_in(const core::Input& input, core::Time now) {
  if (half_is_over()) begin_half();
  if (!stopped_) {
    records_.put(now == core::kNever ? records_.last() : now, input);
    show();
  }
  if (next_ != nullptr) next_->goes_in(input, now);
}

void FlightRecorder::goes_out(core::Line line, wire::ByteView framed_slices) {
  records_.put_written(records_.last(), line, framed_slices);
  show();
  if (next_ != nullptr) next_->goes_out(line, framed_slices);
}

void FlightRecorder::taken(const core::Event& event, core::Time now) {
  records_.put(now, event);
  show();
  if (next_ != nullptr) next_->taken(event, now);
}

void FlightRecorder::taken(const core::ReceivedPacket& packet, core::Time now) {
  records_.put(now, Taken(packet));
  show();
  if (next_ != nullptr) next_->taken(packet, now);
}

}  // namespace limb_ring::recorder
