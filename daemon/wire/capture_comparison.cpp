#include "wire/capture_comparison.h"

#include <algorithm>

namespace limb_ring::capture {

namespace {

struct Differences {
  std::string text;

  void add(bool differs, const std::string& what) {
    if (differs) text += (text.empty() ? "" : ", ") + what;
  }
};

bool other_condition(const CaptureInfo& a, const CaptureInfo& b) {
  return a.crc_bad != b.crc_bad || a.aborted != b.aborted || a.truncated != b.truncated || a.retry != b.retry ||
         a.own != b.own;
}

bool other_place(const CaptureInfo& a, const CaptureInfo& b) {
  return a.embedded != b.embedded || a.carrier_source != b.carrier_source || a.carrier_offset != b.carrier_offset;
}

void compare_bytes(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b, Differences& differences) {
  const auto [at, other] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  if (at == a.end() && other == b.end()) return;
  differences.add(a.size() != b.size(), "size");
  differences.add(true, "bytes from " + std::to_string(at - a.begin()));
}

std::string difference(const CapturedPacket& a, const CapturedPacket& b) {
  Differences differences;
  differences.add(a.time_ns != b.time_ns, "time");
  differences.add(a.info.from != b.info.from || a.info.to != b.info.to || a.info.input != b.info.input, "line");
  compare_bytes(a.bytes, b.bytes, differences);
  differences.add(other_condition(a.info, b.info), "condition");
  differences.add(other_place(a.info, b.info), "the packet it is in");
  differences.add(a.info.span != b.info.span, "time it took");
  differences.add(a.lost_before != b.lost_before, "packets lost before it");
  return differences.text;
}

std::string difference(const CapturedEvent& a, const CapturedEvent& b) {
  Differences differences;
  differences.add(a.time_ns != b.time_ns, "time");
  differences.add(a.node != b.node, "node");
  differences.add(a.what != b.what, "event");
  return differences.text;
}

}  // namespace

std::string difference(const PcapngReader::Record& first, const PcapngReader::Record& second) {
  if (first.index() != second.index()) return "one is a packet, the other an event";
  if (const auto* packet = std::get_if<CapturedPacket>(&first))
    return difference(*packet, std::get<CapturedPacket>(second));
  return difference(std::get<CapturedEvent>(first), std::get<CapturedEvent>(second));
}

CaptureComparison compare(PcapngReader& first, PcapngReader& second,
                          const std::function<void(std::uint64_t)>& goes_on) {
  CaptureComparison result;
  for (;; ++result.equal) {
    if (goes_on && result.equal % 4096 == 0) goes_on(result.equal);
    auto a = first.next();
    auto b = second.next();
    if (!a && !b) return result;
    if (a && b && difference(*a, *b).empty()) continue;
    result.first = std::move(a);
    result.second = std::move(b);
    return result;
  }
}

}  // namespace limb_ring::capture
