#pragma once

#include <atomic>
#include <cstddef>
#include <string>

#include "io/unique_fd.h"

namespace limb_ring::process {

/// A file as memory that other processes have, too. If somebody cuts it off, an access behind its end would end this
/// process (SIGBUS): there it finds zeros instead, and what it writes is seen by nobody else. (ours)
class MappedFile {
 public:
  /// Makes it anew, with all its room on the disk: a disk that was full later would be as if it was cut off.
  /// @throw std::system_error naming it
  static MappedFile make(const std::string& path, std::size_t size);
  /// One that is open. @param protection as of mmap(2) @param size in bytes; it has that many @param path for errors
  /// @throw std::system_error
  MappedFile(const UniqueFd& file, std::size_t size, int protection, const std::string& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  void* data() const { return data_; }
  std::size_t size() const { return size_; }
  /// It was found to be shorter than it was mapped.
  bool is_cut_off() const;

  struct Guard;  ///< what is known of a mapping where a signal is handled

 private:
  void* data_;
  std::size_t size_;
  Guard* guard_;
};

/// Gives an open file this size, with all its room on the disk. @throw std::system_error naming it
void allocate(const UniqueFd& file, std::size_t size, const std::string& path);

}  // namespace limb_ring::process
