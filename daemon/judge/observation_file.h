#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/mapped_file.h"
#include "judge/observation.h"

namespace limb_ring::promises {

struct ObservationRing;  ///< how it lies in the file

/// Where a node's observations are written: a mapped file of bounded size, for any number of readers. A reader that is
/// too slow loses some, and knows how many. The node never waits, and what it has written survives a kill. (ours)
class ObservationFile final : public ObservationSink {
 public:
  /// One that is there is replaced. @throw std::system_error
  explicit ObservationFile(std::string path);
  ~ObservationFile() override;  ///< the file goes with it

  void put(const Observation& seen) override;
  const std::string& path() const { return path_; }
  /// False where it was removed from its folder, which who has it open does not see, or cut off.
  bool is_there() const;
  /// Makes it anew with all that it holds. Who has the old one open sees nothing more, and has to follow().
  /// @throw std::system_error
  void make_again();
  /// Written so far.
  std::uint64_t count() const { return count_; }

 private:
  std::string path_;
  process::MappedFile file_;
  ObservationRing* ring_;
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

  /// Goes on where it is in a file that was made again; at `from`, and what is before it is lost, if the old one was
  /// cut off. @param from count() when it was made again @throw std::runtime_error where it is no such file
  void follow(const std::string& path, std::uint64_t from);

 private:
  process::MappedFile file_;
  ObservationRing* ring_;
  std::uint64_t next_;
  std::uint64_t lost_ = 0;  ///< since the last read()
};

}  // namespace limb_ring::promises
