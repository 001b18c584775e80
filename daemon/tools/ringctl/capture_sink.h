#pragma once

#include <iosfwd>
#include <memory>

#include "tools/capture_text/packet_text.h"

namespace limb_ring::ringctl {

/// Where `dump` puts what it sees.
class CaptureSink {
 public:
  virtual ~CaptureSink() = default;
  virtual void packet(const CapturedPacket& packet) = 0;
  virtual void event(const capture::CapturedEvent& event) = 0;
  /// Writes what is buffered, since somebody may be reading it now.
  /// @return false if nothing can be written any more (a closed pipe, a full disk)
  virtual bool flush() = 0;
  /// Why a flush() was false: names the file. Empty where nobody reads standard output any more (`| head`): that is no
  /// problem.
  const std::string& problem() const { return problem_; }
  bool wanted() const { return wanted_; }

 protected:
  bool flush_to(std::ostream& out, const std::string& path);

 private:
  std::string problem_;
  bool wanted_ = true;
};

/// Lines of text on standard output.
std::unique_ptr<CaptureSink> text_sink(const capture::RingNames& names, const app::PacketTextOptions& options);
/// Lines of JSON on standard output.
std::unique_ptr<CaptureSink> json_sink(const capture::RingNames& names);
/// pcapng in a file, or on standard output where the path is "-". @throw UsageError
std::unique_ptr<CaptureSink> file_sink(const capture::RingNames& names, const std::string& path);

}  // namespace limb_ring::ringctl
