#pragma once

#include <fcntl.h>

#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

#include "io/unique_fd.h"

namespace limb_ring::process {

/// Opens a file in a folder where anything may lie by its name: a FIFO would let us wait for its other end, a link
/// would let us write into somebody's file, so that nothing but a regular file is opened.
/// @param flags as of open(2), beside those that this takes care of; a new file is the user's alone
/// @return an invalid one if there is none; errno says why
UniqueFd open_regular(const std::string& path, int flags = O_RDONLY);
/// Why that has just failed, in words: "it is a FIFO, not a regular file; remove it".
std::string why_not_opened(const std::string& path);

/// "/run/robot/3.lock is a FIFO, not a regular file"; empty if it is one, or nothing is there.
std::string why_not_regular(const std::string& path);

/// The text of an open file, from its beginning.
std::string text_of(const UniqueFd& file);
/// The same of one by its path; empty if open_regular() opens none.
std::string text_of_regular(const std::string& path);

/// A file that one process at a time has locked (F_OFD_SETLK), the first line of which says who: its pid. The kernel
/// frees it when the process ends, however it ends; children do not inherit it. Others can query the lock without
/// taking it, so that a process that only asks is never mistaken for a holder.
class LockFile {
 public:
  /// @return nothing if another process has it
  /// @throw std::runtime_error naming the file and what is wrong with it; std::system_error if the system says so
  static std::optional<LockFile> take(const std::string& path);

  /// Makes this its text. @throw std::system_error
  void write(const std::string& text) const;
  /// False if the file was removed, so that another process can lock one of its own.
  bool is_in_place() const;
  /// Removes the file, unless it is another's by now.
  void remove() const;

 private:
  LockFile(std::string path, UniqueFd file) : path_(std::move(path)), file_(std::move(file)) {}

  std::string path_;
  UniqueFd file_;
};

/// "pid 4711 (ringd)": who holds the lock file there, as far as can be known.
std::string lock_holder(const std::string& path);

/// A fresh folder below the system's temporary one, removed with all in it. One whose process was killed is removed by
/// the next process that makes one for the same purpose: nobody holds the lock in it any more.
class TemporaryFolder {
 public:
  /// @param purpose a word in its name, for people who find one that was left behind: limb_ring_PURPOSE_XXXXXX
  /// @throw std::system_error if none can be made
  explicit TemporaryFolder(const std::string& purpose);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + '/' + name; }

 private:
  std::string path_;
  std::optional<LockFile> lock_;
};

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
