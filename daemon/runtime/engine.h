#pragma once

#include <boost/asio/io_context.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/network_controller.h"
#include "event_loop/packet_loop.h"
#include "event_loop/packet_timer.h"
#include "runtime/clock.h"
#include "runtime/node_line.h"
#include "setup/link_settings.h"

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

/// Drives the core: bytes from the links and the time go in, what comes out goes onto the lines and to the listener.
/// One read, one write: all slices of a batch are handed in before anything is written.
class Engine final : private LineHandler, private core::NetworkController::Tap {
 public:
  Engine(boost::asio::io_context& io, const core::Settings& core, const setup::LinkSettings& links,
         EngineListener& listener);
  ~Engine() { close(); }

  core::NetworkController& controller() { return controller_; }
  const core::NetworkController& controller() const { return controller_; }
  bool has_second_line() const { return second_.has_value(); }
  /// @pre has_second_line(), for the second
  NodeLine& line(core::Line line) { return line == core::Line::first ? first_ : *second_; }
  const NodeLine& line(core::Line line) const { return line == core::Line::first ? first_ : *second_; }
  /// When the first line's input was last lost, or where it fell silent, when it was last heard.
  core::Time input_lost_at() const { return input_lost_at_; }
  /// When this node came to know of a broken line.
  core::Time broken_since() const { return broken_since_; }
  const Clock& clock() const { return clock_; }
  /// One instant for all that a batch, and what follows from it, sets off: that it came in at.
  core::Time now() const { return in_batch_ || pumping_ ? at_ : clock_.now(); }

  /// To be called after anything was asked of the controller. Calling it from within a handler
  /// only makes another round follow.
  void pump();
  /// The same at the end of the event loop's turn, once for all that comes in it: for what comes with every packet.
  void pump_soon();
  void close();
  /// The links' listening sockets, in a runtime folder that was removed. @throw std::runtime_error
  void listen_again();
  /// From now on `tap`, which may be null, sees the lines; it must outlive that.
  void set_tap(LineTap* tap);

 private:
  void on_slice(core::Line line, const wire::Slice& slice) override;
  void on_batch_end() override { pump_soon(); }
  void on_input_gap(core::Line line) override;
  void on_input_up(core::Line line, wire::NodeId from) override;
  void on_input_lost(core::Line line, std::string_view reason) override;
  void on_output_up(core::Line line, wire::NodeId to) override;
  void on_output_lost(core::Line line, std::string_view reason) override;
  void on_output_ready(core::Line line) override;
  void on_unknown_peer(core::Line line, std::string_view reason) override;
  void on_output_refused(core::Line line, wire::NodeId by, std::string_view reason) override;

  void arrives(const wire::Slice& slice, core::Line on, core::Time now) override;
  void leaves(wire::ByteView framed_slices, core::Line on, core::Time now) override;

  void say(core::Line line, const std::string& what);
  void round();
  void note(const core::Event& event);
  void write_lines();
  void write(core::Line line);
  void arm_timer();

  Clock clock_;
  EngineListener& listener_;
  core::NetworkController controller_;
  event_loop::PacketLoop& loop_;
  event_loop::PacketTimer timer_;
  core::Time armed_for_ = core::kNever;
  core::Time deadline_{};
  core::Time at_{};
  LineTap* tap_ = nullptr;
  core::Time input_lost_at_{};
  core::Time broken_since_{};
  core::Duration silence_;
  bool in_batch_ = false;
  bool pumping_ = false;
  bool again_ = false;
  bool pump_asked_ = false;
  bool closed_ = false;
  NodeLine first_;
  std::optional<NodeLine> second_;
};

}  // namespace limb_ring::runtime
