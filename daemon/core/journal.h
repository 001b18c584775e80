#pragma once

#include <variant>

#include "core/events.h"
#include "core/line.h"
#include "core/membership/membership.h"
#include "core/receive/receive.h"
#include "core/send_request.h"
#include "wire/slice.h"

namespace limb_ring::core {

/// What is done to a network controller, as values: each is a call of network_controller.h with its arguments.
namespace input {
struct InputUp {
  Line line;
  NodeId from;
  template <class Archive>
  void archive(Archive& a) {
    a("line", line)("from", from);
  }
};
struct InputLost {
  Line line;
  template <class Archive>
  void archive(Archive& a) {
    a("line", line);
  }
};
struct InputGap {
  Line line;
  template <class Archive>
  void archive(Archive& a) {
    a("line", line);
  }
};
struct OutputUp {
  Line line;
  NodeId to;
  template <class Archive>
  void archive(Archive& a) {
    a("line", line)("to", to);
  }
};
struct OutputLost {
  Line line;
  template <class Archive>
  void archive(Archive& a) {
    a("line", line);
  }
};
struct OutputReady {
  Line line;
  bool ready;
  template <class Archive>
  void archive(Archive& a) {
    a("line", line)("ready", ready);
  }
};
struct Receive {
  Line line;
  wire::Slice slice;
  bool only_passes = false;  ///< a whole packet with a good CRC whose data the node does not look at
  template <class Archive>
  void archive(Archive& a) {
    a("line", line)("kind", slice.kind)("bytes", slice.bytes);
  }
};
struct Send {
  SendRequest request;
  template <class Archive>
  void archive(Archive& a) {
    a("request", request);
  }
};
struct Interrupt {
  InterruptRequest request;
  template <class Archive>
  void archive(Archive& a) {
    a("request", request);
  }
};
struct Pull {
  Owner owner;
  std::uint32_t token;
  std::uint32_t input;
  template <class Archive>
  void archive(Archive& a) {
    a("owner", owner)("token", token)("input", input);
  }
};
struct Cancel {
  Owner owner;
  template <class Archive>
  void archive(Archive& a) {
    a("owner", owner);
  }
};
struct CpuReset {
  Owner cpu;
  template <class Archive>
  void archive(Archive& a) {
    a("cpu", cpu);
  }
};
struct Cpu {
  CpuReport report;
  template <class Archive>
  void archive(Archive& a) {
    a("report", report);
  }
};
struct CpuPresent {
  bool present;
  template <class Archive>
  void archive(Archive& a) {
    a("present", present);
  }
};
struct Timeout {
  template <class Archive>
  void archive(Archive&) {}
};
struct Run {
  template <class Archive>
  void archive(Archive&) {}
};
}  // namespace input

using Input = std::variant<input::InputUp, input::InputLost, input::InputGap, input::OutputUp, input::OutputLost,
                           input::OutputReady, input::Receive, input::Send, input::Interrupt, input::Pull,
                           input::Cancel, input::CpuReset, input::Cpu, input::CpuPresent, input::Timeout, input::Run>;

/// Sees all that goes into a network controller and all that is taken out of it, in order: enough to replay it exactly.
/// (ours)
class Journal {
 public:
  virtual ~Journal() = default;
  /// `input` is the next call.
  /// @param now kNever for set_output_ready() and set_cpu_present(), which are not told the time
  virtual void goes_in(const Input& input, Time now) = 0;
  /// Framed slices of that line, which are about to be written.
  virtual void goes_out(Line line, wire::ByteView framed_slices) = 0;
  virtual void taken(const Event& event, Time now) = 0;
  virtual void taken(const ReceivedPacket& packet, Time now) = 0;
};

}  // namespace limb_ring::core
