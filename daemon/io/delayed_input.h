#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>

#include "io/endpoint.h"
#include "io/input_handler.h"
#include "io/link_counters.h"

namespace limb_ring::link {

/// A long line: hands everything on to another handler `delay` later, in order. (ours)
/// Holds up to kLimit bytes of slices, framed; slices beyond that are dropped and become one gap.
class DelayedInput : public InputHandler {
 public:
  static constexpr std::size_t kLimit = 4 << 20;

  DelayedInput(boost::asio::io_context& io, nanoseconds delay, InputHandler& next, InputCounters& counters);
  ~DelayedInput() override { close(); }
  /// Drops what is on the line; no calls after this.
  void close();

  void on_slice(const wire::Slice& slice) override;
  void on_batch_end() override;
  void on_input_gap() override;
  void on_input_up(std::uint8_t from) override;
  void on_input_lost(std::string_view reason) override;
  void on_unknown_peer(std::string_view reason) override;

 private:
  struct Event {
    enum class Kind : std::uint8_t { gap, batch_end, other } kind;
    std::size_t size;                            ///< bytes of its slice, framed; 0 where it is none
    std::function<void(InputHandler&)> deliver;  ///< not of a gap
    Time due{};
  };
  struct Line;

  void add(Event event);

  nanoseconds delay_;
  InputCounters& counters_;
  std::shared_ptr<Line> line_;
};

}  // namespace limb_ring::link
