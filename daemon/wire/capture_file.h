#pragma once

#include <fstream>
#include <string>

#include "wire/pcapng_reader.h"

namespace limb_ring::capture {

/// A capture file that stays open while it is read.
class CaptureFile {
 public:
  /// @param path "-": standard input @throw CaptureFileError where it cannot be read, or is no capture
  explicit CaptureFile(const std::string& path);
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;

  PcapngReader& reader() { return reader_; }

 private:
  std::ifstream file_;
  PcapngReader reader_;
};

}  // namespace limb_ring::capture
