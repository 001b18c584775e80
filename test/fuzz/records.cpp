// Records of a flight recorder, given any bytes: what is read is written and read again, and is the same.
#include <algorithm>

#include "fuzz/fuzz.h"
#include "recorder/record.h"

using namespace limb_ring;

namespace {

/// @param space where the record is written, with its time, as a recorder leaves it
/// @return that part of it
wire::ByteView written(const recorder::Record& record, core::Time last, std::vector<std::uint8_t>& space) {
  core::StateWriter writer(space.data(), space.size());
  if (const auto* input = std::get_if<core::Input>(&record.what)) {
    recorder::write(writer, record.at, *input, last);
  } else if (const auto* slices = std::get_if<recorder::Written>(&record.what)) {
    recorder::write(writer, record.at, *slices, last);
  } else if (const auto* event = std::get_if<core::Event>(&record.what)) {
    recorder::write(writer, record.at, *event, last);
  } else {
    recorder::write(writer, record.at, std::get<core::ReceivedPacket>(record.what), last);
  }
  fuzz::require(!writer.failed(), "a record that was read can be written");
  return {space.data(), writer.size()};
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static std::vector<std::uint8_t> space(1u << 17), more(1u << 17);
  core::StateReader reader({data, size});
  core::Time last{};
  while (!reader.complete()) {
    const core::Time before = last;
    const auto record = recorder::read(reader, last);
    if (!record) return 0;
    fuzz::require(record->at == last && last >= before, "time does not run backwards");
    const wire::ByteView once = written(*record, before, space);
    core::StateReader again(once);
    core::Time then = before;
    const auto same = recorder::read(again, then);
    fuzz::require(same && again.complete(), "what was written is a record");
    const wire::ByteView twice = written(*same, before, more);
    fuzz::require(std::equal(once.begin(), once.end(), twice.begin(), twice.end()), "and the same one");
  }
  return 0;
}
