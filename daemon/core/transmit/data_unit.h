#pragma once

#include <array>
#include <deque>

#include "core/send_request.h"
#include "core/slot_queue.h"
#include "core/transmit/send_unit.h"

namespace limb_ring::core {

/// The data packet unit of Transmit: a queue per priority, one DATP outstanding. (paper) Refused packets are sent again
/// later, as new packets; hellos and beacons go before all else. (ours, protocol.md sections 4.3 to 4.6)
class DataUnit final : public SendUnit {
 public:
  DataUnit(const Settings& settings, Counters& counters, EventQueue& events) : SendUnit(settings, counters, events) {}

  /// @return Reject::none if it was queued; its SendEnded comes later
  Reject enqueue(const SendRequest& request, Time now);
  /// Hello or beacon: a broadcast on channel 1, before everything else.
  void enqueue_control(wire::ByteView message, std::uint32_t token, Time now);
  /// Removes the NC's own packets from their queue; they get no outcome. @pre !busy()
  void drop_control() {
    jobs_ -= queues_[kControlQueue].size();
    queues_[kControlQueue].clear();
  }

  /// When it began, or will begin, to ask for the line; kNever: it does not.
  Time ready_at() const {
    if (flight_.phase() == Flight::Phase::waiting) return flight_.waiting_since();
    if (flight_.phase() == Flight::Phase::out || jobs_ == 0) return kNever;
    return next_ready();
  }
  /// It gets the line. @return the packet that goes now. @pre ready_at() <= now
  wire::ByteView start(Time now);

  void handle_timeout(Time now) {
    if (deadline() <= now) end_overdue(now);
  }
  Time deadline() const { return any_waits() ? waiting_deadline() : flight_.deadline(); }

  /// As SendUnit::set_open_chain(); also ends refused sends of which an earlier try may have been taken: in an open
  /// chain this node may not hear that their receiver has forgotten that. (ours, protocol.md section 8.4)
  void set_open_chain(bool open, Time now);
  /// As SendUnit::forgotten_by(); also ends a refused send of which an earlier try may have been taken.
  void forgotten_by(NodeId peer, Time now);
  /// Ends all sends of one owner `cancelled`; one that is out is no longer repeated.
  void cancel(Owner owner, Time now);
  /// Ends everything, the NC's own too. The sequence numbers go on.
  void restart(Time now);

  bool has_control_end() const { return !control_ends_.empty(); }
  /// Ends of the NC's own sends since the last call, at most one at a time.
  bool take_control_end(SendEnded& out);

  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    archive_unit(a);
    a("queues", queues_)("jobs", jobs_)("current", current_)("control_ends", control_ends_);
  }

 private:
  struct JobState : Send {
    std::uint8_t pri = 0;
    Time not_before{};   ///< held back after a refusal
    Duration backoff{};  ///< how long the next refusal holds it back
    Time refused_until = kNever;
    std::uint16_t size = 0;
  };
  struct Job : JobState {
    std::array<std::uint8_t, wire::kMaxPayload> data;
    template <class Archive>
    void archive(Archive& a) {
      Send::archive(a);
      a("pri", pri)("not_before", not_before)("backoff", backoff);
      a("refused_until", refused_until)("size", size)("data", data, size);
    }
  };
  using Queue = SlotQueue<Job>;
  static constexpr std::size_t kControlQueue = 0;
  static constexpr std::size_t kQueues = 5;  ///< control, then priorities 0 to 3

  Job& outstanding() override { return queues_[current_].front(); }
  void pop_outstanding() override { pop(queues_[current_]); }
  void count_return() override { ++counters_.returned_data; }
  bool goes_again(Time at) override;
  void give_out(const SendEnded& ended, Time at) override;

  /// True if something waits for the line, or for its time.
  bool any_waits() const { return jobs_ > (flight_.phase() == Flight::Phase::out ? 1u : 0u); }
  /// The front of `queue` waits for the line, or for its time, with no try out or to be repeated.
  bool front_waits(std::size_t queue) const { return !queues_[queue].empty() && (flight_.idle() || queue != current_); }
  Time next_ready() const;
  Time front_ready(std::size_t queue) const;
  std::size_t choose(Time now) const;
  template <class Predicate>
  void end_doubtful(Outcome outcome, Time now, Predicate is_meant);
  void push(Queue& queue, const SendRequest& request, Time now);
  void pop(Queue& queue) {
    queue.pop();
    --jobs_;
  }
  void load(const Job& job);
  static Outcome overdue_outcome(const Job& job);
  void end_overdue(Time now);
  Time waiting_deadline() const;
  void end_waiting(Queue& queue, Outcome outcome, Time now);
  /// The head of `queue` is gone: the send behind it is due from now on, not since it was asked for.
  static void hold_next(Queue& queue, Time now);

  std::size_t jobs_ = 0;     ///< in all queues
  std::size_t current_ = 0;  ///< queue whose front is outstanding
  std::array<Queue, kQueues> queues_;
  std::deque<SendEnded> control_ends_;
};

}  // namespace limb_ring::core
