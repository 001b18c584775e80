#include "tools/ringctl/trace_svg.h"

#include <algorithm>
#include <sstream>

#include "config/xml_text.h"
#include "tools/ringctl/trace_words.h"

namespace limb_ring::ringctl {

namespace {

using capture::Hop;
using capture::SeenPacket;
using std::chrono::nanoseconds;

// In pixels.
constexpr double kLabels = 130, kLines = 760, kRow = 26, kBar = 16, kTop = 56, kMargin = 20, kThinnest = 2;
constexpr std::int64_t kMostTicks = 8;

constexpr const char* kPacket = "#1f6fb2";
constexpr const char* kWaiting = "#bcd9f0";
constexpr const char* kOther = "#9a9a9a";
constexpr const char* kInterrupt = "#d02020";

/// 1, 2 or 5 times a power of ten, so that not too many ticks fit into the time.
std::int64_t tick_of(nanoseconds time) {
  for (std::int64_t tick = 1;; tick *= 10)
    for (const std::int64_t step : {tick, 2 * tick, 5 * tick})
      if (time.count() / step <= kMostTicks) return step;
}

class Picture {
 public:
  Picture(const capture::PacketTrace& trace, const capture::RingNames& names) : trace_(trace), names_(names) {}

  std::string draw() {
    const double height = kTop + kRow * static_cast<double>(trace_.hops.size()) + 2 * kRow;
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << kLabels + kLines + kMargin << "\" height=\""
         << height << "\" font-family=\"sans-serif\" font-size=\"12\">\n"
         << "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
    text(kMargin, 20, title_of(trace_, names_), "start");
    text(kMargin, 38, end_words(trace_, names_), "start");
    axis();
    for (std::size_t row = 0; row < trace_.hops.size(); ++row) hop(row);
    out_ << "</svg>\n";
    return out_.str();
  }

 private:
  double x(nanoseconds time) const {
    const double whole = std::max<double>(1, static_cast<double>((trace_.ended - trace_.began).count()));
    const double share = static_cast<double>((time - trace_.began).count()) / whole;
    return kLabels + kLines * std::clamp(share, 0.0, 1.0);
  }
  static double y(std::size_t row) { return kTop + kRow * static_cast<double>(row); }

  void text(double x, double y, const std::string& words, const char* anchor) {
    out_ << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\">" << config::xml_text(words)
         << "</text>\n";
  }

  void bar(nanoseconds from, nanoseconds to, std::size_t row, const char* colour, const std::string& title) {
    const double left = x(from), width = std::max(kThinnest, x(to) - left);
    out_ << "<rect x=\"" << left << "\" y=\"" << y(row) << "\" width=\"" << width << "\" height=\"" << kBar
         << "\" fill=\"" << colour << "\"><title>" << config::xml_text(title) << "</title></rect>\n";
  }

  void axis() {
    const double bottom = y(trace_.hops.size());
    const std::int64_t tick = tick_of(trace_.ended - trace_.began);
    for (nanoseconds at{0}; at <= trace_.ended - trace_.began; at += nanoseconds(tick)) {
      const double place = x(trace_.began + at);
      out_ << "<path d=\"M" << place << " " << kTop - 6 << "V" << bottom << "\" stroke=\"#dddddd\"/>\n";
      text(place, bottom + 16, in_us(at), "middle");
    }
    text(kMargin, bottom + 16, "us", "start");
  }

  void seen(const SeenPacket& packet, std::size_t row, const char* colour) {
    bar(packet.began, packet.last, row, packet.interrupt() ? kInterrupt : colour, packet_words(packet, names_));
  }

  void hop(std::size_t row) {
    const Hop& hop = trace_.hops[row];
    text(kLabels - 8, y(row) + kBar - 4, names_.of(hop.node), "end");
    for (const SeenPacket& other : hop.behind) seen(other, row, kOther);
    if (hop.waited()) wait(hop, row);
    if (hop.out || hop.in) bar(line(hop).began, line(hop).last, row, kPacket, hop_words(trace_, row, names_));
    for (const SeenPacket& cut : hop.cut_by) seen(cut, row, kInterrupt);
  }

  /// Draws the wait below the packets that it waited for, so that these stay visible.
  void wait(const Hop& hop, std::size_t row) {
    const double left = x(hop.in->began), width = x(hop.out->began) - left;
    if (width <= 0) return;
    out_ << "<rect x=\"" << left << "\" y=\"" << y(row) + kBar << "\" width=\"" << width << "\" height=\"4\" fill=\""
         << kWaiting << "\"><title>waited " << in_us(*hop.waited()) << " us</title></rect>\n";
  }

  static const SeenPacket& line(const Hop& hop) { return hop.out ? *hop.out : *hop.in; }

  const capture::PacketTrace& trace_;
  const capture::RingNames& names_;
  std::ostringstream out_;
};

}  // namespace

std::string trace_svg(const capture::PacketTrace& trace, const capture::RingNames& names) {
  return Picture(trace, names).draw();
}

}  // namespace limb_ring::ringctl
