#include "recorder/recording.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "core/archive.h"
#include "wire/checksum.h"

namespace limb_ring::recorder {
namespace {

std::uint64_t load(wire::ByteView bytes, std::size_t at) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data + at, sizeof value);
  return value;
}

Title read_title(wire::ByteView bytes) {
  if (bytes.size < kTitleSize || std::memcmp(bytes.data, kMagic.data(), kMagic.size()) != 0)
    throw std::runtime_error("this is no recording of a node");
  Title title;
  core::StateReader reader(bytes.first(kTitleSize).from(kMagic.size()));
  title.archive(reader);
  const bool fits = title.half >= sizeof(HalfHead) && title.half <= (bytes.size - kTitleSize) / 2;
  if (reader.failed() || !fits) throw std::runtime_error("the recording's title is damaged");
  return title;
}

}  // namespace

Recording read_recording(wire::ByteView bytes) {
  Recording recording;
  recording.title = read_title(bytes);
  for (std::size_t i = 0; i < 2; ++i) {
    const wire::ByteView half = bytes.from(kTitleSize + i * recording.title.half).first(recording.title.half);
    const std::uint64_t generation = load(half, 0), used = load(half, 8);
    if (generation == 0) continue;
    if (used > half.size - sizeof(HalfHead)) throw std::runtime_error("the recording's half is damaged");
    recording.halves.push_back({generation, half.from(sizeof(HalfHead)).first(used)});
  }
  auto& halves = recording.halves;
  if (halves.empty()) throw std::runtime_error("nothing was recorded");
  std::sort(halves.begin(), halves.end(), [](const auto& a, const auto& b) { return a.generation < b.generation; });
  if (halves.size() == 2 && halves[0].generation + 1 != halves[1].generation) halves.erase(halves.begin());
  return recording;
}

std::vector<std::uint8_t> seal(const std::vector<std::uint8_t>& recording) {
  std::vector<std::uint8_t> saved = recording;
  saved.resize(saved.size() + wire::kCrcSize);
  wire::store_u32(saved.data() + recording.size(), wire::crc32({recording.data(), recording.size()}));
  return saved;
}

wire::ByteView unseal(wire::ByteView saved) {
  if (saved.size < wire::kCrcSize) throw std::runtime_error("this is no saved recording");
  const wire::ByteView bytes = saved.first(saved.size - wire::kCrcSize);
  if (wire::crc32(bytes) != wire::load_u32(bytes.end()))
    throw std::runtime_error("it was changed since it was saved, or cut off: its CRC differs");
  return bytes;
}

}  // namespace limb_ring::recorder
