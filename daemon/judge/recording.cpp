#include "judge/recording.h"

#include <algorithm>
#include <bitset>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "core/archive.h"
#include "judge/flight_recorder.h"
#include "wire/checksum.h"

namespace limb_ring::recorder {
namespace {

constexpr int kMostTries = 100;

/// A core can be made of it.
bool usable(const core::Settings& settings) {
  constexpr core::Duration kLongest = std::chrono::hours(24 * 366);
  constexpr unsigned kMost = 1u << 16;
  std::bitset<256> nodes;
  for (const wire::NodeId node : settings.order) nodes.set(node);
  const auto fits = [&](core::Duration span) { return span >= core::Duration{0} && span <= kLongest; };
  return nodes.count() == settings.order.size() && nodes[settings.id] && !nodes[wire::kBroadcast] &&
         settings.insertion_buffer <= kMost && settings.interrupt_buffer <= kMost && settings.send_queue <= kMost &&
         settings.receive_buffers <= kMost && fits(settings.byte_time_out) && fits(settings.byte_time_in) &&
         fits(settings.relay_delay) && fits(settings.lap) && fits(settings.all_delays) &&
         fits(settings.send_timeout_least) && fits(settings.refused_for) && fits(settings.refused_backoff) &&
         fits(settings.refused_backoff_most) && fits(settings.queue_timeout) && fits(settings.stall) &&
         fits(settings.beacon) && fits(settings.break_grace) && fits(settings.fold_permission) &&
         fits(settings.unconfirmed_pace);
}

/// Copies the half as it was at one instant. If the recorder starts it afresh during the copy, the copy is repeated.
void save_half(wire::ByteView half, std::vector<std::uint8_t>& saved) {
  const auto& head = *reinterpret_cast<const HalfHead*>(half.data);
  const std::size_t at = saved.size();
  for (int tries = 0; tries < kMostTries; ++tries) {
    const std::uint64_t generation = head.generation.load(std::memory_order_acquire);
    const std::uint64_t used = generation == 0 ? 0 : head.used.load(std::memory_order_acquire);
    if (used > half.size - sizeof(HalfHead)) continue;
    saved.resize(at);
    for (const std::uint64_t number : {generation, used}) {
      const auto* first = reinterpret_cast<const std::uint8_t*>(&number);
      saved.insert(saved.end(), first, first + sizeof number);
    }
    const wire::ByteView bytes = half.from(sizeof(HalfHead)).first(used);
    saved.insert(saved.end(), bytes.begin(), bytes.end());
    std::atomic_thread_fence(std::memory_order_acquire);
    if (head.generation.load(std::memory_order_relaxed) == generation) return;
  }
  throw std::runtime_error("the recorder writes faster than it can be read; enlarge recorder.size");
}

wire::ByteView take(wire::ByteView& bytes, std::size_t size) {
  if (size > bytes.size) throw std::runtime_error("the recording is cut off");
  const wire::ByteView taken = bytes.first(size);
  bytes = bytes.from(size);
  return taken;
}

std::uint64_t take_number(wire::ByteView& bytes) {
  std::uint64_t value = 0;
  std::memcpy(&value, take(bytes, sizeof value).data, sizeof value);
  return value;
}

wire::ByteView checked(wire::ByteView saved) {
  if (saved.size < kTitleSize + wire::kCrcSize) throw std::runtime_error("this is not a saved recording");
  const wire::ByteView bytes = saved.first(saved.size - wire::kCrcSize);
  if (wire::crc32(bytes) != wire::load_u32(bytes.end()))
    throw std::runtime_error("it was changed since it was saved, or cut off: its CRC differs");
  return bytes;
}

}  // namespace

Title read_title(wire::ByteView bytes) {
  constexpr std::size_t kForm = kMagic.size() - 1;  // the last letter is the form
  if (bytes.size < kTitleSize || std::memcmp(bytes.data, kMagic.data(), kForm) != 0)
    throw std::runtime_error("this is not a recording of a node");
  if (bytes[kForm] != static_cast<std::uint8_t>(kMagic[kForm]))
    throw std::runtime_error("it was recorded by another version of limb_ring, in a form that this one does not read");
  Title title;
  core::StateReader reader(bytes.first(kTitleSize).from(kMagic.size()));
  title.archive(reader);
  const bool aligned = title.half >= sizeof(HalfHead) && title.half % alignof(HalfHead) == 0;
  if (reader.failed() || !aligned || !usable(title.settings))
    throw std::runtime_error("the recording's title is damaged");
  return title;
}

std::vector<std::uint8_t> save(wire::ByteView memory) {
  const Title title = read_title(memory);
  if (title.half > (memory.size - kTitleSize) / 2) throw std::runtime_error("the recording is cut off");
  std::vector<std::uint8_t> saved(memory.begin(), memory.begin() + kTitleSize);
  for (std::size_t i = 0; i < 2; ++i) save_half(memory.from(kTitleSize + i * title.half).first(title.half), saved);
  const std::uint32_t crc = wire::crc32({saved.data(), saved.size()});
  saved.resize(saved.size() + wire::kCrcSize);
  wire::store_u32(saved.data() + saved.size() - wire::kCrcSize, crc);
  return saved;
}

Recording read_saved(wire::ByteView saved) {
  wire::ByteView bytes = checked(saved);
  Recording recording;
  recording.title = read_title(take(bytes, kTitleSize));
  for (int i = 0; i < 2; ++i) {
    Recording::Half half;
    half.generation = take_number(bytes);
    half.bytes = take(bytes, take_number(bytes));
    if (half.generation != 0) recording.halves.push_back(half);
  }
  auto& halves = recording.halves;
  if (halves.empty()) throw std::runtime_error("nothing was recorded");
  std::sort(halves.begin(), halves.end(), [](const auto& a, const auto& b) { return a.generation < b.generation; });
  if (halves.size() == 2 && halves[0].generation + 1 != halves[1].generation) halves.erase(halves.begin());
  return recording;
}

namespace fs = std::filesystem;

namespace {

/// A save of that ring: behind the prefix stands a date. Ring `leg` keeps away from those of ring `leg-8`.
bool is_save(const std::string& name, const std::string& prefix) {
  static const std::string kDate = "0000-00-00_";
  if (name.rfind(prefix, 0) != 0 || name.size() < prefix.size() + kDate.size()) return false;
  return std::equal(kDate.begin(), kDate.end(), name.begin() + static_cast<std::ptrdiff_t>(prefix.size()),
                    [](char form, char c) { return form == '0' ? c >= '0' && c <= '9' : form == c; });
}

}  // namespace

SavedRing save_ring(const std::string& ring_folder, const std::string& to) {
  SavedRing saved;
  for (const std::string& recording : recordings_in(ring_folder)) {
    fs::create_directories(to);
    try {
      saved.bytes += save_file(recording, (fs::path(to) / fs::path(recording).filename()).string());
      ++saved.recordings;
    } catch (const std::exception& problem) {
      saved.problems.push_back(recording + ": " + problem.what());
    }
  }
  return saved;
}

void remove_old_saves(const std::string& newest, const std::string& prefix, std::size_t keep) {
  using Age = std::pair<bool, fs::file_time_type>;  // one from the future was made before the clock was set back
  std::vector<std::pair<Age, fs::path>> others;
  std::error_code error;
  const auto now = fs::file_time_type::clock::now();
  const fs::path kept = fs::path(newest).filename();
  for (fs::directory_iterator it(fs::path(newest).parent_path(), error), end; !error && it != end;
       it.increment(error)) {
    const fs::path name = it->path().filename();
    if (name == kept || !is_save(name.string(), prefix) || !it->is_directory(error)) continue;
    const auto made = it->last_write_time(error);
    others.push_back({{made <= now, made}, it->path()});
  }
  std::sort(others.begin(), others.end());
  for (std::size_t i = 0; i + keep < others.size() + 1; ++i) fs::remove_all(others[i].second, error);
}

}  // namespace limb_ring::recorder
