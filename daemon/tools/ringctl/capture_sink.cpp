#include "tools/ringctl/capture_sink.h"

#include <iostream>

#include "tools/capture_text/packet_bytes.h"
#include "tools/cli/output.h"
#include "tools/common/out_file.h"
#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

namespace {

constexpr const char* kNameOfOutput = "standard output";

class TextSink final : public CaptureSink {
 public:
  TextSink(const capture::RingNames& names, const app::PacketTextOptions& options) : text_(names, options) {}
  void packet(const CapturedPacket& packet) override { std::cout << text_.line(packet) << '\n'; }
  void event(const capture::CapturedEvent& event) override { std::cout << text_.line(event) << '\n'; }
  bool flush() override { return flush_to(std::cout, kNameOfOutput); }

 private:
  app::PacketText text_;
};

class JsonSink final : public CaptureSink {
 public:
  explicit JsonSink(capture::RingNames names) : names_(std::move(names)) {}
  void packet(const CapturedPacket& packet) override { std::cout << app::packet_json(packet, names_) << '\n'; }
  void event(const capture::CapturedEvent& event) override { std::cout << app::event_json(event, names_) << '\n'; }
  bool flush() override { return flush_to(std::cout, kNameOfOutput); }

 private:
  capture::RingNames names_;
};

class FileSink final : public CaptureSink {
 public:
  FileSink(const capture::RingNames& names, const std::string& path)
      : path_(path == app::kStandardOutput ? kNameOfOutput : path),
        out_(open(path) ? file_ : std::cout),
        writer_(out_, names) {}
  void packet(const CapturedPacket& packet) override {
    writer_.packet(packet.time_ns, packet.info, app::bytes_of(packet), packet.lost_before);
  }
  void event(const capture::CapturedEvent& event) override { writer_.event(event.time_ns, event.node, event.what); }
  bool flush() override { return flush_to(out_, path_); }

 private:
  /// @return false where standard output is meant
  bool open(const std::string& path) {
    if (path == app::kStandardOutput) return false;
    const std::string problem = app::open_for_writing(file_, path);
    if (!problem.empty()) throw UsageError(problem);
    return true;
  }

  std::string path_;
  std::ofstream file_;
  std::ostream& out_;
  capture::PcapngWriter writer_;
};

}  // namespace

bool CaptureSink::flush_to(std::ostream& out, const std::string& path) {
  if (&out == &std::cout && !app::is_output_read()) wanted_ = false;
  if (wanted_ && problem_.empty()) problem_ = cli::finish_writing(out, path);
  return wanted_ && problem_.empty();
}

std::unique_ptr<CaptureSink> text_sink(const capture::RingNames& names, const app::PacketTextOptions& options) {
  return std::make_unique<TextSink>(names, options);
}

std::unique_ptr<CaptureSink> json_sink(const capture::RingNames& names) { return std::make_unique<JsonSink>(names); }

std::unique_ptr<CaptureSink> file_sink(const capture::RingNames& names, const std::string& path) {
  return std::make_unique<FileSink>(names, path);
}

}  // namespace limb_ring::ringctl
