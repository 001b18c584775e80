// Records of a flight recorder, given any bytes: what is read is written and read again, and is the same.
#include <algorithm>

#include "fuzz/fuzz.h"
#include "judge/record.h"

using namespace limb_ring;
using recorder::Record;

namespace {

void write(recorder::RecordWriter& writer, const Record& record) {
  std::visit([&](const auto& what) { writer.put(record.at, what); }, record.what);
  fuzz::require(!writer.failed(), "a record that was read can be written");
}

std::vector<std::uint8_t> bytes_of(const Record& record) {
  if (const auto* input = std::get_if<core::Input>(&record.what))
    return std::visit([](const auto& call) { return recorder::bytes_of(call); }, *input);
  if (const auto* written = std::get_if<recorder::Written>(&record.what)) return recorder::bytes_of(*written);
  if (const auto* event = std::get_if<core::Event>(&record.what)) return recorder::bytes_of(*event);
  return recorder::bytes_of(std::get<recorder::Taken>(record.what));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static std::vector<std::uint8_t> space(1u << 23);
  recorder::RecordReader reader({data, size}, core::Time{});
  recorder::RecordWriter writer(core::StateWriter(space.data(), space.size()), core::Time{});
  core::Time last{};
  std::vector<std::vector<std::uint8_t>> expected;
  while (!reader.complete() && writer.left() > space.size() / 2) {
    const auto record = reader.next();
    if (!record) break;
    fuzz::require(record->at >= last, "time does not run backwards");
    last = record->at;
    write(writer, *record);
    expected.push_back(bytes_of(*record));
  }
  recorder::RecordReader again({space.data(), writer.size()}, core::Time{});
  for (const auto& bytes : expected) {
    const auto record = again.next();
    fuzz::require(record && bytes_of(*record) == bytes, "what was written is the same record");
  }
  fuzz::require(again.complete() && writer.last() == last, "and there is no other");
  return 0;
}
