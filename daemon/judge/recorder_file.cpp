#include "judge/recorder_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "io/regular_file.h"
#include "io/throw_errno.h"
#include "io/unique_fd.h"
#include "judge/recording.h"

namespace limb_ring::recorder {
namespace {

using process::throw_errno;

constexpr const char* kExtension = ".record";
constexpr const char* kFormer = ".former";
constexpr const char* kNew = ".new";

// Writes to each page now, so that no packet has to wait for a page fault. MAP_POPULATE would only make them readable.
process::MappedFile touched(process::MappedFile file) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  for (std::size_t at = 0; at < file.size(); at += page) static_cast<volatile std::uint8_t*>(file.data())[at] = 0;
  return file;
}

bool write_all(int fd, const std::vector<std::uint8_t>& data) {
  for (std::size_t written = 0; written < data.size();) {
    const ssize_t more = ::write(fd, data.data() + written, data.size() - written);
    if (more < 0 && errno != EINTR) return false;
    if (more > 0) written += static_cast<std::size_t>(more);
  }
  return true;
}

// A part of a recording cannot be replayed; it would only be in the way of the next save.
void write_whole(const std::vector<std::uint8_t>& data, const std::string& path) {
  const process::UniqueFd file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file.valid()) throw_errno("cannot write " + path);
  if (write_all(file.get(), data)) return;
  const int error = errno;
  ::unlink(path.c_str());
  errno = error;
  throw_errno("cannot write " + path);
}

}  // namespace

RecorderFile::RecorderFile(const std::string& path, std::size_t size, core::NetworkController& controller,
                           const Title& title, core::Time now, std::function<void()> on_too_small)
    : path_(path),
      memory_(touched(process::MappedFile::make(path + kNew, size))),
      recorder_(controller, static_cast<std::uint8_t*>(memory_.data()), size, title, now, std::move(on_too_small)) {
  // Only now: a start that fails, as where the disk is full, leaves the recordings of both lives as they are.
  ::rename(path.c_str(), (path + kFormer).c_str());  // fails where there is none
  if (::rename((path + kNew).c_str(), path.c_str()) != 0) throw_errno("cannot make " + path);
}

bool RecorderFile::is_in_place() const { return !memory_.is_cut_off() && ::access(path_.c_str(), F_OK) == 0; }

std::string recording_of(const std::string& folder, unsigned id) {
  return folder + '/' + std::to_string(id) + kExtension;
}

std::vector<std::string> recordings_in(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::filesystem::path& path = it->path();
    const std::filesystem::path recording = is_of_former_life(path.string()) ? path.stem() : path;
    if (recording.extension() == kExtension && !it->is_directory(error)) files.push_back(path.string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool is_of_former_life(const std::string& recording) { return std::filesystem::path(recording).extension() == kFormer; }

std::size_t save_file(const std::string& recording, const std::string& to) {
  const process::UniqueFd file = process::open_regular(recording);
  struct stat status {};
  if (!file.valid() || ::fstat(file.get(), &status) != 0)
    throw std::runtime_error("cannot read " + recording + ": " + process::why_not_opened(recording));
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) throw std::runtime_error(recording + " is empty");
  const process::MappedFile mapped(file, size, PROT_READ, recording);
  const std::vector<std::uint8_t> saved = save({static_cast<const std::uint8_t*>(mapped.data()), size});
  if (mapped.is_cut_off()) throw std::runtime_error(recording + " was cut off while it was read");
  write_whole(saved, to);
  return saved.size();
}

}  // namespace limb_ring::recorder
