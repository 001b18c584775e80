#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "judge/observation.h"

namespace limb_ring::promises {

struct ObservationRing;  ///< how it lies in the file
struct UnmapRing {
  void operator()(ObservationRing* ring) const;
};
using MappedRing = std::unique_ptr<ObservationRing, UnmapRing>;

/// Where a node's observations are written: a mapped file of bounded size, for any number of readers. A reader that is
/// too slow loses some, and knows how many. The node never waits, and what it has written survives a kill. (ours)
class ObservationFile final : public ObservationSink {
 public:
  /// One that is there is replaced. @throw std::system_error
  explicit ObservationFile(std::string path);
  ~ObservationFile() override;  ///< the file goes with it

  void put(const Observation& seen) override;
  const std::string& path() const { return path_; }
  /// False where it was removed from its folder; who has it open sees no difference.
  bool is_there() const;
  /// Makes it anew with all that it holds. Who has the old one open sees nothing more, and has to follow().
  /// @throw std::system_error
  void make_again();
  /// Written so far.
  std::uint64_t count() const { return count_; }

 private:
  std::string path_;
  MappedRing ring_;
  std::uint64_t count_ = 0;
};

/// The other side of it.
class ObservationReader {
 public:
  /// @param from count() at which it begins
  /// @throw std::runtime_error where it is no such file
  ObservationReader(const std::string& path, std::uint64_t from);

  /// All that has come since, into `seen`, which is emptied before. @return so many were lost before these
  std::uint64_t read(std::vector<Observation>& seen);

  /// Goes on where it is in a file that was made again. @throw std::runtime_error where it is no such file
  void follow(const std::string& path);

 private:
  MappedRing ring_;
  std::uint64_t next_;
};

}  // namespace limb_ring::promises
