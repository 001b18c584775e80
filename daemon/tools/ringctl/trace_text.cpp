#include "tools/common/text_table.h"
#include "tools/ringctl/trace_words.h"

namespace limb_ring::ringctl {

using capture::Hop;

namespace {

std::string time_or_dash(const std::optional<capture::SeenPacket>& seen, std::chrono::nanoseconds since) {
  return seen ? in_us(seen->began - since) : "-";
}

std::string us_or_dash(const std::optional<std::chrono::nanoseconds>& time) { return time ? in_us(*time) : "-"; }

}  // namespace

std::string trace_text(const capture::PacketTrace& trace, const capture::RingNames& names) {
  std::string text = title_of(trace, names) + "  " + end_words(trace, names) + "\n";
  for (const std::string& words : retry_words(trace, names)) text += words + "\n";
  std::vector<std::vector<std::string>> rows{{"node", "line, us", "in, us", "out, us", "waited", "why"}};
  for (std::size_t i = 0; i < trace.hops.size(); ++i) {
    const Hop& hop = trace.hops[i];
    rows.push_back({names.of(hop.node), us_or_dash(trace.on_line(i)), time_or_dash(hop.in, trace.began),
                    time_or_dash(hop.out, trace.began), us_or_dash(hop.waited()), hop_words(trace, i, names)});
  }
  return text + app::text_table(rows);
}

}  // namespace limb_ring::ringctl
