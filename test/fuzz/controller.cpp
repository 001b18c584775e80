// Any slices, in any order and at any time, into a network controller: it goes on, and what it gives out are slices.
#include "core/network_controller.h"
#include "fuzz/fuzz.h"

using namespace limb_ring;
using core::Line;
using core::Time;

namespace {

core::Settings settings_from(fuzz::Input& input) {
  core::Settings settings;
  const std::uint8_t how = input.byte();
  settings.id = wire::NodeId{2};
  settings.order.clear();
  for (unsigned id = 0; id < 3u + how % 4u; ++id) settings.order.push_back(static_cast<wire::NodeId>(id));
  settings.fold_back = (how & 0x40) != 0;
  if (how & 0x80) settings.byte_time_in = settings.byte_time_out = std::chrono::nanoseconds(8);
  return settings;
}

/// As whoever drives it does, behind every input.
void drive(core::NetworkController& node, Time now) {
  if (node.next_deadline(now) <= now) node.apply(core::input::Timeout{}, now);
  node.apply(core::input::Run{}, now);
  core::Event event;
  core::ReceivedPacket packet;
  unsigned given_out = 0;
  while (node.take_event(now, event)) fuzz::require(++given_out < 10000, "events of an instant end");
  while (node.take(now, packet)) fuzz::require(packet.size <= wire::kMaxPayload, "a packet has its size");
  for (const Line line : node.lines()) {
    wire::each_slice(node.output(line).view(), [](const wire::Slice& slice) {
      fuzz::require(wire::slice_size_fits(slice.kind, slice.bytes.size), "what is given out are slices");
    });
    node.output(line).clear();
  }
}

/// One input, chosen by the first byte. @return when it is in
Time step(core::NetworkController& node, fuzz::Input& input, Time now) {
  const std::uint8_t what = input.byte();
  const Line line = (what & 0x80) != 0 ? Line::second : Line::first;
  const wire::NodeId neighbour{static_cast<std::uint8_t>(what & 0x40 ? 1 : 3)};
  switch (what & 0x0F) {
    case 0:
      node.apply(core::input::InputLost{line}, now);
      return now;
    case 1:
      node.apply(core::input::InputLost{line}, now);
      node.apply(core::input::InputUp{line, neighbour}, now);
      return now;
    case 2:
      node.apply(core::input::OutputLost{line}, now);
      return now;
    case 3:
      node.apply(core::input::OutputLost{line}, now);
      node.apply(core::input::OutputUp{line, neighbour}, now);
      return now;
    case 4:
      node.apply(core::input::InputGap{line}, now);
      return now;
    case 5:
      return now + std::chrono::microseconds(input.byte());
    case 6:
      return now + std::chrono::milliseconds(input.byte());
    case 7: {
      core::SendRequest request;
      request.owner = 1;
      request.destination = wire::NodeId{input.byte()};
      request.priority = wire::Priority{input.byte()};
      request.data = input.bytes(input.byte());
      node.apply(core::input::Send{request}, now);
      return now;
    }
    case 8:
      node.apply(core::input::Interrupt{{1, 1, wire::NodeId{input.byte()}, wire::Factor{input.byte()}}}, now);
      return now;
    case 9:
      node.set_output_ready(line, (what & 0x40) != 0);
      return now;
    case 10:
      node.set_cpu_present((what & 0x40) != 0);
      return now;
    case 11:
      node.apply(core::input::CpuReset{1}, now);
      return now;
    default: {
      const auto kind = static_cast<wire::SliceKind>(1 + input.byte() % 8);
      wire::ByteView bytes = input.bytes(input.byte() * 2u);
      while (!wire::slice_size_fits(kind, bytes.size)) {  // as the line's parser would have it
        if (bytes.empty()) return now;
        bytes = bytes.first(bytes.size - 1);
      }
      node.receive(line, {kind, bytes}, now);
      return now;
    }
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const core::Settings settings = settings_from(input);
  Time now{};
  core::NetworkController node(settings, now);
  for (const Line line : node.lines()) {
    node.apply(core::input::InputUp{line, line == Line::first ? wire::NodeId{1} : wire::NodeId{3}}, now);
    node.apply(core::input::OutputUp{line, line == Line::first ? wire::NodeId{3} : wire::NodeId{1}}, now);
  }
  while (!input.empty()) {
    now = step(node, input, now);
    drive(node, now);
  }
  return 0;
}
