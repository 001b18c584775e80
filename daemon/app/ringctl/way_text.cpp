#include "app/common/text_table.h"
#include "app/ringctl/way_words.h"

namespace limb_ring::ringctl {

using capture::Hop;

namespace {

std::string time_or_dash(const std::optional<capture::SeenPacket>& seen, std::chrono::nanoseconds since) {
  return seen ? in_us(seen->began - since) : "-";
}

}  // namespace

std::string way_text(const capture::Way& way, const capture::RingNames& names) {
  std::string text = title_of(way, names) + "  " + end_words(way, names) + "\n";
  for (const std::string& words : retry_words(way, names)) text += words + "\n";
  std::vector<std::vector<std::string>> rows{{"node", "in, us", "out, us", "waited", "why"}};
  for (const Hop& hop : way.hops) {
    const auto waited = hop.waited();
    rows.push_back({names.of(hop.node), time_or_dash(hop.in, way.began), time_or_dash(hop.out, way.began),
                    waited ? in_us(*waited) : "-", hop_words(hop, names)});
  }
  return text + app::text_table(rows);
}

}  // namespace limb_ring::ringctl
