#include "wire/capture_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace limb_ring::capture {

namespace {

// A folder can be opened like a file, but not read.
std::ifstream opened(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw CaptureFileError(path + ": cannot be read: it is a folder");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw CaptureFileError(path + ": cannot be read: " + std::strerror(errno));
  return file;
}

}  // namespace

CaptureFile::CaptureFile(const std::string& path)
    : file_(opened(path == "-" ? "/dev/stdin" : path)), reader_(file_, path == "-" ? "standard input" : path) {}

}  // namespace limb_ring::capture
