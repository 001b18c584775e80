// A saved recording that somebody has changed, and whose CRC is right again: it is replayed, or refused with a reason.
#include <cstring>
#include <stdexcept>
#include <vector>

#include "fuzz/fuzz.h"
#include "judge/flight_recorder.h"
#include "judge/recording.h"
#include "judge/replay.h"
#include "wire/checksum.h"

using namespace limb_ring;
using core::Line;
using core::Time;

namespace {

using Bytes = std::vector<std::uint8_t>;
/// So much of a title is not 0.
constexpr std::size_t kTitle = 1024;

/// What a node of three leaves that has joined, sent and received.
Bytes recorded(bool fold_back) {
  core::Settings settings;
  settings.id = wire::NodeId{1};
  settings.order = {wire::NodeId{0}, wire::NodeId{1}, wire::NodeId{2}};
  settings.fold_back = fold_back;
  settings.insertion_buffer = settings.interrupt_buffer = settings.send_queue = settings.receive_buffers = 2;
  Time now{};
  core::NetworkController node(settings, now);
  std::vector<std::uint64_t> memory(recorder::FlightRecorder::kLeast / sizeof(std::uint64_t));
  auto* bytes = reinterpret_cast<std::uint8_t*>(memory.data());
  recorder::Title title;
  title.settings = settings;
  recorder::FlightRecorder recorder(node, bytes, recorder::FlightRecorder::kLeast, title, now, [] {});
  for (const Line line : node.lines()) {
    node.apply(core::input::InputUp{line, wire::NodeId{0}}, now);
    node.apply(core::input::OutputUp{line, wire::NodeId{2}}, now);
  }
  core::SendRequest request;
  request.owner = 1;
  const std::uint8_t data[] = {1, 2, 3, 4};
  request.data = {data, sizeof data};
  node.apply(core::input::Send{request}, now);
  node.apply(core::input::Run{}, now);
  return recorder::save({bytes, recorder::FlightRecorder::kLeast});
}

/// Bytes of its title are others, and records of any kind follow behind those that are there. The state of the core is
/// as it was: only the CRC speaks for that.
Bytes changed(Bytes saved, fuzz::Input& input) {
  saved.resize(saved.size() - wire::kCrcSize);
  for (std::uint8_t changes = input.byte() & 0x0F; changes != 0; --changes) {
    const std::size_t at = input.byte() << 8 | input.byte();
    saved[at % kTitle] = input.byte();
  }
  // Of the two halves the second one was written, and the first is empty: | generation | size | generation | size | ...
  const wire::ByteView more = input.bytes(4096);
  saved.insert(saved.end(), more.begin(), more.end());
  std::uint8_t* const used = &saved[recorder::kTitleSize + 3 * sizeof(std::uint64_t)];
  std::uint64_t size = 0;
  std::memcpy(&size, used, sizeof size);
  size += more.size;
  std::memcpy(used, &size, sizeof size);
  saved.resize(saved.size() + wire::kCrcSize);
  const std::size_t covered = saved.size() - wire::kCrcSize;
  wire::store_u32(&saved[covered], wire::crc32({saved.data(), covered}));
  return saved;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Bytes usual = recorded(false), folding = recorded(true);
  fuzz::Input input(data, size);
  const std::uint8_t how = input.byte();
  const Bytes saved = changed((how & 1) != 0 ? folding : usual, input);
  try {
    const recorder::Recording recording = recorder::read_saved({saved.data(), saved.size()});
    recorder::PacketData packets;
    recorder::Replay replay(recording, packets);
    // Takes long; the first input of a process is always put into words, so what crashed does again.
    static unsigned runs = 0;
    const bool in_words = runs++ % 256 == 0;
    while (replay.step())
      if (in_words) recorder::describe(replay.last());
    if (in_words) recorder::describe_state(replay.controller());
  } catch (const std::runtime_error& problem) {
    fuzz::require(problem.what()[0] != '\0', "a problem is named");
  }
  return 0;
}
