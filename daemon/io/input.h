#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "io/delayed_input.h"
#include "io/input_handler.h"
#include "io/upstream.h"

namespace limb_ring::link {

/// The receiving end of the link INTO a node: listens (for nodes of its own host and of others), has one upstream
/// neighbour at a time, and takes a nearer one, or the same restarted, in its place. Tells the neighbour every `idle`
/// that this end lives. One thread, one io_context. Not to be destroyed from within a call of its handler.
class Input {
 public:
  /// @throw std::runtime_error where it cannot listen: names the endpoint, the cause, the cure
  Input(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler);
  ~Input() { close(); }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  /// Hangs up and stops listening. No call of the handler afterwards.
  void close();

  /// As InputLine's.
  bool is_in_place() const;
  /// As InputLine's. @throw std::runtime_error
  void listen_again() {
    for (const auto& line : lines_) line->listen_again();
  }

  bool up() const { return from().has_value(); }
  std::optional<std::uint8_t> from() const { return upstream_.from(); }
  const InputCounters& counters() const { return report_.counters; }
  /// Nodes that were refused for a reason that asking again does not mend.
  const Refusals& refusals() const { return report_.refusals; }
  /// Why the last unknown peer was turned away; empty where there was none.
  const std::string& last_unknown_peer() const { return report_.last_unknown_peer; }

 private:
  void open(boost::asio::io_context& io, InputSettings settings, const Endpoint& endpoint, InputHandler& handler);

  InputReport report_;
  std::unique_ptr<DelayedInput> delay_;
  Upstream upstream_;
  std::vector<std::shared_ptr<InputLine>> lines_;
};

}  // namespace limb_ring::link
