#pragma once

#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "config/line_faults.h"
#include "core/line.h"
#include "core/network_controller.h"
#include "io/input.h"
#include "io/node_clock.h"
#include "io/output.h"
#include "io/packet_loop.h"
#include "judge/flight_recorder.h"
#include "node/link_settings.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

/// A line out of this node with its faults on purpose, between the Engine and the Output. While there is a fault, every
/// slice passes through it; while there is none, it costs nothing. (ours)
///
/// Idles are sent by the link itself and do not pass through here. So a line that drops every packet is not silent,
/// but one that stalls or is cut is.
class FaultyLine final : public LineBreaker {
 public:
  FaultyLine(boost::asio::io_context& io, const Clock& clock, link::Output& output);

  /// The wire is neither cut nor held: the output is, or will be, connected.
  bool carries() const { return wire_ == link::Wire::whole; }
  void put(wire::ByteView framed_slices, core::Time now) {
    if (active_) return pass_all(framed_slices, now);
    output_.write(framed_slices);
  }
  bool mended() const override { return output_.up() || !carries(); }
  /// The output was lost, or leads to another node.
  void line_lost() { faults_.line_lost(); }

  fault::LineFaults::Id begin(const fault::Fault& fault, core::Time now) override;
  bool remove(fault::LineFaults::Id id, core::Time now) override;
  void clear(core::Time now) override;
  std::vector<fault::LineFaults::Listed> list(core::Time now) override { return faults_.list(now); }

  const fault::LineCounters& counters() const override { return faults_.counters(); }
  void close() { timer_.cancel(); }

 private:
  void pass_all(wire::ByteView framed_slices, core::Time now);
  void pass(const wire::Slice& slice, core::Time now);
  void update(core::Time now);
  void write_due(core::Time now);
  void arm_timer();

  const Clock& clock_;
  link::Output& output_;
  fault::LineFaults faults_;
  event_loop::PacketTimer timer_;
  wire::SliceWriter due_;
  link::Wire wire_ = link::Wire::whole;
  bool active_ = false;  ///< something is wrong, or still held back
};

/// What happens on the lines of a node, with the line it happens on. Names as in io/input.h.
struct LineHandler {
  virtual void on_slice(core::Line line, const wire::Slice& slice) = 0;
  virtual void on_batch_end() = 0;
  virtual void on_input_gap(core::Line line) = 0;
  virtual void on_input_up(core::Line line, wire::NodeId from) = 0;
  virtual void on_input_lost(core::Line line, std::string_view reason) = 0;
  virtual void on_output_up(core::Line line, wire::NodeId to) = 0;
  virtual void on_output_lost(core::Line line, std::string_view reason) = 0;
  virtual void on_output_ready(core::Line line) = 0;
  virtual void on_unknown_peer(core::Line line, std::string_view reason) = 0;
  virtual void on_output_refused(core::Line line, wire::NodeId by, std::string_view reason) = 0;

 protected:
  ~LineHandler() = default;
};

/// A line of the ring at this node: the link into the node, the link out of it, and the latter's faults on purpose.
class NodeLine final : private link::InputHandler, private link::OutputHandler {
 public:
  /// All but `links` must outlive this.
  NodeLine(boost::asio::io_context& io, const Clock& clock, const setup::LinkSettings& links, LineHandler& handler);

  core::Line line() const { return line_; }
  const link::Input& input() const { return input_; }
  const link::Output& output() const { return output_; }
  FaultyLine& faulty_line() { return faulty_line_; }
  const FaultyLine& faulty_line() const { return faulty_line_; }
  /// Puts it onto the line; leaves `slices` empty.
  void write(wire::SliceWriter& slices, core::Time now);
  void close();
  /// Makes the listening socket again, after the runtime folder was removed. @throw std::runtime_error
  void listen_again() { input_.listen_again(); }

 private:
  void on_slice(const wire::Slice& slice) override { handler_.on_slice(line_, slice); }
  void on_batch_end() override { handler_.on_batch_end(); }
  void on_input_gap() override { handler_.on_input_gap(line_); }
  void on_input_up(std::uint8_t from) override { handler_.on_input_up(line_, wire::NodeId{from}); }
  void on_input_lost(std::string_view reason) override { handler_.on_input_lost(line_, reason); }
  void on_output_up(std::uint8_t to) override { handler_.on_output_up(line_, wire::NodeId{to}); }
  void on_output_lost(std::string_view reason) override;
  void on_output_ready() override { handler_.on_output_ready(line_); }
  void on_unknown_peer(std::string_view reason) override { handler_.on_unknown_peer(line_, reason); }
  void on_output_refused(std::uint8_t by, std::string_view reason) override {
    handler_.on_output_refused(line_, wire::NodeId{by}, reason);
  }

  core::Line line_;
  LineHandler& handler_;
  link::Input input_;
  link::Output output_;
  FaultyLine faulty_line_;
};

/// Drives the core: bytes from the links and the time go in, what comes out goes onto the lines and to the listener.
/// One read, one write: all slices of a batch are handed in before anything is written.
class Engine final : public NodeDriver, private LineHandler, private core::Tap {
 public:
  Engine(boost::asio::io_context& io, const core::Settings& core, const std::vector<setup::LinkSettings>& lines,
         DriverListener& listener);
  ~Engine() override { close(); }

  core::NetworkController& controller() override { return controller_; }
  const core::NetworkController& controller() const override { return controller_; }
  event_loop::NodeClock& clock() override { return machine_clock_; }
  core::Time now() const override { return in_batch_ || pumping_ ? at_ : clock_.now(); }
  event_loop::NodeClock::Time steady(core::Time when) const override { return clock_.steady(when); }

  /// From now on everything that goes into the controller and comes out of it is written into that file.
  /// @param title `zero`, `date` and `settings` are filled in
  /// @throw std::system_error if the file cannot be made
  void record(const std::string& path, std::size_t size, recorder::Title title);

  void pump() override;
  void pump_soon() override;
  void pump_around(const std::function<void(core::Time now)>& call) override;
  void close() override;
  bool is_in_place() const override;
  void listen_again() override;
  void set_tap(LineTap* tap) override;
  void set_journal(core::Journal* journal) override;

  LineEnds ends(core::Line line) const override;
  const link::InputCounters& input_counters(core::Line on) const override { return line(on).input().counters(); }
  const link::OutputCounters& output_counters(core::Line on) const override { return line(on).output().counters(); }
  LineRefusals refusals(core::Line on) const override {
    return {&line(on).input().refusals(), &line(on).output().refusals()};
  }
  LineBreaker& breaker(core::Line on) override { return line(on).faulty_line(); }
  const LineBreaker& breaker(core::Line on) const override { return line(on).faulty_line(); }
  std::string last_loss() const override { return last_loss_; }
  core::Time input_lost_at() const override { return input_lost_at_; }
  core::Time broken_since() const override { return broken_since_; }

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

  NodeLine& line(core::Line line) { return lines_[static_cast<std::size_t>(line)]; }
  const NodeLine& line(core::Line line) const { return lines_[static_cast<std::size_t>(line)]; }
  void tell_lost(core::Line line, bool input, std::string_view reason);
  void round();
  void note(const core::Event& event);
  void write_lines();
  void arm_timer();

  Clock clock_;
  event_loop::MachineClock machine_clock_;
  DriverListener& listener_;
  core::NetworkController controller_;
  bool recording_is_in_place() const;

  std::unique_ptr<recorder::RecorderFile> recorder_;
  std::function<void()> record_again_;  ///< into a new file
  core::Journal* journal_ = nullptr;    ///< set_journal()'s
  event_loop::PacketLoop& loop_;
  event_loop::PacketTimer timer_;
  core::Time armed_for_ = core::kNever;
  core::Time may_put_off_at_{};  ///< the timer, to a later instant
  core::Time deadline_{};
  core::Time at_{};
  LineTap* tap_ = nullptr;
  std::string last_loss_;
  core::Time input_lost_at_{};
  core::Time broken_since_{};
  core::Duration silence_;
  bool in_batch_ = false;
  bool pumping_ = false;
  bool again_ = false;
  bool pump_asked_ = false;
  bool closed_ = false;
  std::deque<NodeLine> lines_;
};

}  // namespace limb_ring::runtime
