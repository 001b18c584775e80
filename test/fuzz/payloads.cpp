// What CPUs put into packets: joint states and commands, sensor readings, orders to a firmware.
#include "fuzz/fuzz.h"
#include "limb_ring/payload/announcement.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"
#include "tools/firmware/options.h"

using namespace limb_ring;

namespace {

/// What decodes can be encoded, and decodes again.
template <class Decode>
void decode(payload::ByteView bytes, Decode decode) {
  const auto message = decode(bytes);
  if (!message) return;
  const auto again = encode(*message);
  fuzz::require(static_cast<bool>(again), "what decodes is encoded");
  fuzz::require(static_cast<bool>(decode({again->data(), again->size()})), "what is encoded decodes");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const payload::ByteView bytes{data, size};
  decode(bytes, payload::decode_joint_state);
  decode(bytes, payload::decode_joint_command);
  decode(bytes, payload::decode_command_set);
  decode(bytes, payload::decode_sensor_reading);
  decode(bytes, payload::decode_announcement);
  firmware::parse_fault_command({data, size});
  return 0;
}
