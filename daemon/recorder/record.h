#pragma once

#include <variant>

#include "core/archive.h"
#include "core/journal.h"

/// The records of a flight recorder: what a driver does to a core. (ours)
namespace limb_ring::recorder {

/// Framed slices that the driver took for that line.
struct Written {
  core::Line line;
  wire::ByteView slices;

  template <class Archive>
  void archive(Archive& a) {
    a("line", line)("slices", slices);
  }
};

/// One call of a core: what went in, or what was taken out.
struct Record {
  core::Time at{};  ///< of the call, or of the one before where that one is not told the time
  std::variant<core::Input, Written, core::Event, core::ReceivedPacket> what;
};

/// Bytes of any value that has an archive(), for comparison.
template <class T>
std::vector<std::uint8_t> bytes_of(const T& what) {
  for (std::size_t room = 1024;; room *= 2) {
    std::vector<std::uint8_t> bytes(room);
    core::StateWriter writer(bytes.data(), bytes.size());
    const_cast<T&>(what).archive(writer);  // a writer changes nothing
    if (writer.failed()) continue;
    bytes.resize(writer.size());
    return bytes;
  }
}

}  // namespace limb_ring::recorder
