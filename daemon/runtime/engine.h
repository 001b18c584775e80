#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <string_view>

#include "core/controller.h"
#include "link/input.h"
#include "link/output.h"
#include "runtime/clock.h"
#include "runtime/faulty_line.h"
#include "runtime/second_line.h"
#include "runtime/settings.h"

namespace limb_ring::runtime {

/// What comes out of the network controller. Handlers may call into the controller.
struct EngineListener {
  virtual ~EngineListener() = default;
  virtual void on_event(const core::Event& event) = 0;
  /// After all else of a round: packets may wait for the CPU.
  virtual void on_round_end() = 0;
  /// A link came or went; for people.
  virtual void on_link(std::string_view what) = 0;
};

/// Sees what comes to the node's controller and leaves it, and changes nothing. Where the ring has folded back
/// that is each packet once, on whichever line; what only passes back on the second one is not shown.
struct LineTap {
  virtual ~LineTap() = default;
  virtual void on_input(const wire::Slice& slice, wire::NodeId from, Clock::Steady::time_point at) = 0;
  virtual void on_output(wire::ByteView framed_slices, wire::NodeId to, Clock::Steady::time_point at) = 0;
  /// Something is missing there, or the line has ended.
  virtual void on_input_gap(Clock::Steady::time_point at) = 0;
  virtual void on_output_gap(Clock::Steady::time_point at) = 0;
};

/// Drives the core: bytes from the links and the time go in, what comes out goes onto the output
/// link and to the listener. One read, one write: all slices of a batch are handed in before
/// anything is written.
class Engine final : private link::InputHandler,
                     private link::OutputHandler,
                     private core::FoldBack::Receiver,
                     private SecondLine::Driver {
 public:
  Engine(boost::asio::io_context& io, const core::Settings& core, const LinkSettings& links,
         EngineListener& listener);
  ~Engine() override { close(); }

  core::Controller& controller() { return controller_; }
  const core::Controller& controller() const { return controller_; }
  const link::Input& input() const { return input_; }
  const link::Output& output() const { return output_; }
  /// Nothing where the ring does not fold back.
  std::optional<SecondLine>& second_line() { return second_; }
  const std::optional<SecondLine>& second_line() const { return second_; }
  FaultyLine& faulty_line() { return faulty_line_; }
  const FaultyLine& faulty_line() const { return faulty_line_; }
  /// When the input was last lost, or where it fell silent, when it was last heard.
  core::Time input_lost_at() const { return input_lost_at_; }
  const Clock& clock() const { return clock_; }
  /// One instant for all that a batch, and what follows from it, sets off: that it came in at.
  core::Time now() const override { return in_batch_ || pumping_ ? at_ : clock_.now(); }

  /// To be called after anything was asked of the controller. Calling it from within a handler
  /// only makes another round follow.
  void pump() override;
  void close();
  /// The links' listening sockets, in a runtime folder that was removed. @throw std::runtime_error
  void listen_again();
  /// From now on `tap`, which may be null, sees the lines; it must outlive that.
  void set_tap(LineTap* tap) { tap_ = tap; }

 private:
  void on_slice(const wire::Slice& slice) override;
  void on_batch_end() override;
  void on_input_gap(std::uint32_t lost) override;
  void on_input_up(std::uint8_t from) override;
  void on_input_lost(std::string_view reason) override;
  void on_stranger(std::string_view reason) override;
  void on_output_up(std::uint8_t to) override;
  void on_output_lost(std::string_view reason) override;
  void on_output_refused(std::uint8_t by, std::string_view reason) override;
  void on_output_ready() override;

  void take(const wire::Slice& slice, core::Time now) override;
  core::Time begin_batch() override;
  void say(std::string_view what) override { listener_.on_link(what); }

  void round();
  void write(wire::SliceWriter& line);
  void show_output();
  void write_line();
  void arm_timer();

  Clock clock_;
  EngineListener& listener_;
  core::Controller controller_;
  boost::asio::steady_timer timer_;
  core::Time armed_for_ = core::kNever;
  core::Time deadline_{};
  core::Time at_{};
  LineTap* tap_ = nullptr;
  core::Time input_lost_at_{};
  core::Duration silence_;
  bool in_batch_ = false;
  bool pumping_ = false;
  bool again_ = false;
  bool closed_ = false;
  link::Input input_;
  link::Output output_;
  FaultyLine faulty_line_;
  std::optional<SecondLine> second_;
};

}  // namespace limb_ring::runtime
