#include "judge/replayed_ring.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "judge/recorder_file.h"

namespace limb_ring::recorder {
namespace {

using std::chrono::nanoseconds;

// Only a regular file: reading a pipe or a device might never end.
std::vector<std::uint8_t> bytes_of_file(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    throw std::runtime_error("is not a file; allowed: a regular file");
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file) throw std::runtime_error("cannot be read");
  return bytes;
}

}  // namespace

ReplayedLife::ReplayedLife(std::string file, std::vector<std::uint8_t> saved, PacketData& data)
    : file_(std::move(file)),
      saved_(std::move(saved)),
      recording_(read_saved({saved_.data(), saved_.size()})),
      replay_(recording_, data),
      began_(machine_time(replay_.next())) {}

nanoseconds ReplayedLife::machine_time(core::Time at) const {
  return nanoseconds(title().zero) + core::whole_nanoseconds(at.time_since_epoch());
}

ReplayedRing::ReplayedRing(const std::string& folder) {
  for (const std::string& path : recordings_in(folder)) {
    try {
      lives_.push_back(std::make_unique<ReplayedLife>(path, bytes_of_file(path), data_));
    } catch (const std::exception& problem) {
      throw std::runtime_error(path + ": " + problem.what());
    }
    const std::string &ring = lives_.back()->title().ring, &first = lives_.front()->title().ring;
    if (ring != first)
      throw std::runtime_error(path + ": is of ring " + ring + ", and " + lives_.front()->file() + " is of ring " +
                               first + "; allowed: recordings of one ring");
  }
  if (lives_.empty()) throw std::runtime_error(folder + ": no recordings are there; 'ringctl record save' makes them");
  const auto first = std::min_element(lives_.begin(), lives_.end(),
                                      [](const auto& a, const auto& b) { return a->began() < b->began(); });
  began_ = (*first)->began();
}

ReplayedLife* ReplayedRing::step(nanoseconds until) {
  ReplayedLife* next = nullptr;
  nanoseconds at = began_ + until;
  for (const auto& life : lives_) {
    Replay& replay = life->replay();
    if (replay.next() == core::kNever || replay.difference()) continue;
    const nanoseconds due = life->machine_time(replay.next());
    if (due > at || (next != nullptr && due == at)) continue;
    next = life.get();
    at = due;
  }
  if (next != nullptr) next->replay().step();
  return next;
}

}  // namespace limb_ring::recorder
