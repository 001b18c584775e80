#pragma once

#include <optional>
#include <variant>

#include "core/archive.h"
#include "core/journal.h"

/// The records of a flight recorder, and how they are read back. Numbers are in the byte order of the machine, as a
/// recording is replayed by the same program. (ours)
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

/// As core::Int128.
__extension__ typedef unsigned __int128 Unsigned128;

/// From one record's time to the next one's: zigzag and LEB128, 1 to 19 bytes, since most steps are short.
class TimeStep {
 public:
  explicit TimeStep(core::Duration step = {}) : step_(step) {}
  core::Duration value() const { return step_; }

  template <class Archive>
  void archive(Archive& a) {
    const core::Int128 count = step_.count();
    Unsigned128 rest = static_cast<Unsigned128>(count) << 1 ^ static_cast<Unsigned128>(count >> 127);
    Unsigned128 read = 0;
    std::uint8_t byte = 0x80;
    for (unsigned shift = 0; (byte & 0x80) != 0 && shift < 133; shift += 7, rest >>= 7) {
      byte = static_cast<std::uint8_t>((rest & 0x7F) | (rest > 0x7F ? 0x80 : 0));
      a("byte", byte);
      read |= static_cast<Unsigned128>(byte & 0x7F) << shift;
    }
    step_ = core::Duration{static_cast<core::Int128>(read >> 1) ^ -static_cast<core::Int128>(read & 1)};
  }

 private:
  core::Duration step_;
};

/// @name Write one record
/// @param room where it is written; failed() afterwards if there was not enough
/// @param last in: the time of the previous record; out: the time of this one
///@{
void write(core::StateWriter& room, core::Time at, const core::Input& input, core::Time& last);
void write(core::StateWriter& room, core::Time at, const Written& written, core::Time& last);
void write(core::StateWriter& room, core::Time at, const core::Event& event, core::Time& last);
void write(core::StateWriter& room, core::Time at, const core::ReceivedPacket& packet, core::Time& last);
///@}
/// @return nothing where the bytes are no record, or one that no driver of a core would leave
std::optional<Record> read(core::StateReader& bytes, core::Time& last);

/// Bytes of any value that has an archive(), for comparison.
template <class T>
std::vector<std::uint8_t> bytes_of(const T& what) {
  std::vector<std::uint8_t> bytes(1024);
  for (;;) {
    core::StateWriter writer(bytes.data(), bytes.size());
    const_cast<T&>(what).archive(writer);  // a writer changes nothing
    if (!writer.failed()) {
      bytes.resize(writer.size());
      return bytes;
    }
    bytes.resize(2 * bytes.size());
  }
}

}  // namespace limb_ring::recorder
