#include "tools/common/picture_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <ostream>

#include "config/urdf_joints.h"
#include "tools/common/text_table.h"

namespace limb_ring::app {

namespace {

using config::xml_text;
using std::chrono::nanoseconds;

// As web/style.css has them.
constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<style>
:root { color-scheme: light dark; --back: #fff; --panel: #f5f6f8; --text: #16181d; --faint: #565d69; --edge: #c5cad3;
  --good: #00795a; --warn: #9a6700; --bad: #b8480a; --off: #6b7280; --line: #0072b2; }
@media (prefers-color-scheme: dark) { :root { --back: #14161a; --panel: #1d2026; --text: #e8eaee; --faint: #a4abb8;
  --edge: #444b57; --good: #3cc9a0; --warn: #f0b429; --bad: #ff8a4c; --off: #8b93a1; --line: #56b4e9; } }
body { margin: 1rem; background: var(--back); color: var(--text); font: 15px/1.45 system-ui, sans-serif; }
figure { display: inline-block; margin: .4rem; padding: .5rem; background: var(--panel); border: 1px solid var(--edge); border-radius: 8px; }
figure.stream { width: 31rem; vertical-align: top; }
figcaption, h2 { font-size: 1rem; margin: 0; } figcaption span { color: var(--faint); }
svg { display: block; max-width: 100%; font: 12px system-ui, sans-serif; }
svg .grid { stroke: var(--edge); } svg .axis { fill: var(--faint); font-size: 11px; text-anchor: middle; }
svg .row { fill: var(--text); text-anchor: end; } svg rect.bar { fill: var(--line); }
svg .bound { stroke: var(--bad); stroke-width: 2; stroke-dasharray: 6 3; } svg text.limit { fill: var(--bad); font-weight: 600; }
svg rect.state { fill: var(--panel); stroke-width: 2; } svg text.state { fill: var(--text); font-size: 11px; }
svg rect.good { stroke: var(--good); } svg rect.warn { stroke: var(--warn); stroke-dasharray: 7 3; }
svg rect.bad { stroke: var(--bad); } svg rect.off { stroke: var(--off); stroke-dasharray: 2 4; }
svg .interrupt { fill: var(--bad); }
</style>
)";

std::string head(const std::string& title) {
  return kHead + ("<title>" + xml_text(title) + "</title></head><body><h1>" + xml_text(title) + "</h1>\n");
}

std::string px(double at) { return number(at, 1); }

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + xml_text(value) + '"';
}

std::string svg(double width, double height, const std::string& label, const std::string& parts) {
  return "<svg role=\"img\"" + attribute("viewBox", "0 0 " + px(width) + ' ' + px(height)) +
         attribute("width", px(width)) + attribute("height", px(height)) + attribute("aria-label", label) + '>' +
         parts + "</svg>";
}

std::string text(const char* style, double x, double y, const std::string& words) {
  return std::string("<text") + attribute("class", style) + attribute("x", px(x)) + attribute("y", px(y)) + '>' +
         xml_text(words) + "</text>";
}

std::string rectangle(const std::string& style, double x, double y, double width, double height,
                      const std::string& title) {
  return "<rect" + attribute("class", style) + attribute("x", px(x)) + attribute("y", px(y)) +
         attribute("width", px(width)) + attribute("height", px(height)) + "><title>" + xml_text(title) +
         "</title></rect>";
}

std::string upright(const char* style, double x, double height) {
  return std::string("<path") + attribute("class", style) + attribute("d", "M" + px(x) + " 0V" + px(height)) + "/>";
}

/// Lines and figures of a scale from 0, some six steps of 1, 2 or 5.
std::string scale(double left, double width, double height, double most, const std::string& unit) {
  const double power = std::pow(10, std::floor(std::log10(most / 6)));
  double step = power;
  for (const double one : {1, 2, 5, 10})
    if (step < most / 6) step = one * power;
  const int digits = std::max(0, -static_cast<int>(std::floor(std::log10(step))));
  std::string parts;
  for (int i = 0; i * step <= most; ++i) {
    const double x = left + width * i * step / most;
    parts += upright("grid", x, height) + text("axis", x, height + 15, number(i * step, digits));
  }
  return parts + text("axis", left + width + 14, height + 15, unit);
}

// ---- latencies ------------------------------------------------------------------------------

constexpr std::size_t kBins = 60;
constexpr double kWidth = 420, kHeight = 110, kLeft = 24, kBelow = 22, kRight = 30;

/// The smallest value that at least this share of all does not exceed (nearest rank). @param sorted not empty
double quantile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

/// Where the scale ends. A few that are far beyond the rest would leave no room for these: the last bar has them.
double end_of_scale(const std::vector<double>& sorted, double bound) {
  const double usual = std::max(1.5 * quantile(sorted, 0.99), bound);
  return (sorted.back() > 1.5 * usual ? usual : std::max(sorted.back(), bound)) * 1.08 + 1e-9;
}

std::string histogram(const StreamLatencies& stream, const std::vector<double>& sorted) {
  const double most = end_of_scale(sorted, stream.bound.value_or(0));
  std::array<std::size_t, kBins> bins{};
  for (const double one : stream.latencies)
    ++bins[std::min(kBins - 1, static_cast<std::size_t>(one / most * static_cast<double>(kBins)))];
  const auto fullest = static_cast<double>(*std::max_element(bins.begin(), bins.end()));
  std::string parts = scale(kLeft, kWidth, kHeight, most, "us");
  for (std::size_t i = 0; i < kBins; ++i) {
    if (bins[i] == 0) continue;
    const double tall = std::max(1.5, (kHeight - 16) * static_cast<double>(bins[i]) / fullest);
    const double from = most / kBins * static_cast<double>(i), x = kLeft + kWidth / kBins * static_cast<double>(i);
    const bool open = i + 1 == kBins && sorted.back() > most;
    parts += rectangle("bar", x, kHeight - tall, kWidth / kBins - 1, tall,
                       std::to_string(bins[i]) + " of " + number(from, 2) +
                           (open ? " us and more" : " to " + number(from + most / kBins, 2) + " us"));
    if (open) parts += text("axis", x, kHeight - tall - 4, "and more");
  }
  if (stream.bound) {
    const double x = kLeft + kWidth * *stream.bound / most;
    const bool right = x < kLeft + kWidth / 2;  // there is room for its words
    parts += upright("bound", x, kHeight) + "<g style=\"text-anchor: " + (right ? "start" : "end") + "\">" +
             text("limit", right ? x + 5 : x - 5, 11, "bound " + number(*stream.bound, 1)) + "</g>";
  }
  return svg(kLeft + kWidth + kRight, kHeight + kBelow, "Histogram of " + stream.name, parts);
}

std::string facts(const StreamLatencies& stream, const std::vector<double>& sorted) {
  const auto late = stream.bound ? sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), *stream.bound) : 0;
  return std::to_string(sorted.size()) + (sorted.size() == 1 ? " message" : " messages") + ", median " +
         number(quantile(sorted, 0.5), 2) + ", 99 % " + number(quantile(sorted, 0.99), 2) + ", largest " +
         number(sorted.back(), 3) + " us" +
         (!stream.bound ? "; no bound"
          : late == 0   ? "; ✓ within its bound"
                        : "; ✕ " + std::to_string(late) + " beyond its bound");
}

}  // namespace

void write_latencies(std::ostream& out, const std::string& title, const std::string& words,
                     const std::vector<StreamLatencies>& streams) {
  out << head(title) << "<p>" << xml_text(words) << "</p>\n";
  for (const StreamLatencies& stream : streams) {
    out << "<figure class=\"stream\"><figcaption>" << xml_text(stream.name) << "<br><span>";
    std::vector<double> sorted = stream.latencies;
    std::sort(sorted.begin(), sorted.end());
    if (sorted.empty())
      out << "no message</span></figcaption></figure>\n";
    else
      out << xml_text(facts(stream, sorted)) << "</span></figcaption>" << histogram(stream, sorted) << "</figure>\n";
  }
  out << "</body></html>\n";
}

// ---- states ---------------------------------------------------------------------------------

namespace {

constexpr double kRow = 20, kNames = 120, kTimes = 900, kEnd = 30;

/// One state of one node.
struct Span {
  std::string state;
  nanoseconds begins, ends;
};

const char* kind_of(const std::string& state) {
  if (state == "up") return "good";
  if (state == "duplicate_id") return "bad";
  return state == "open_chain" || state == "folded" || state == "alone" ? "warn" : "off";
}

/// The state that an event tells of; empty: none.
std::string state_after(const std::string& what) {
  const std::size_t arrow = what.find(" -> ");
  if (arrow != std::string::npos) return what.substr(arrow + 4);
  return what == "killed" ? "down" : what == "frozen" ? what : "";
}

double ms(nanoseconds time) { return static_cast<double>(time.count()) / 1e6; }

std::string state_bar(const std::string& name, const Span& span, double from, double until, double y) {
  const double width = std::max(1.0, until - from);
  const std::string words =
      name + ": " + span.state + ", " + number(ms(span.begins), 3) + " to " + number(ms(span.ends), 3) + " ms";
  const std::string bar = rectangle(std::string("state ") + kind_of(span.state), from, y + 2, width, kRow - 4, words);
  const bool has_room = width > 8 * static_cast<double>(span.state.size());
  return bar + (has_room ? text("state", from + 4, y + 14, span.state) : "");
}

}  // namespace

std::string states_picture(const capture::RingNames& names, const std::vector<capture::CapturedEvent>& events,
                           nanoseconds lasted, const std::vector<TimeMark>& times) {
  const double whole = std::max(1e-6, ms(lasted)), height = kRow * static_cast<double>(names.nodes.size());
  const auto x = [&](nanoseconds at) { return kNames + kTimes * std::clamp(ms(at) / whole, 0.0, 1.0); };
  std::map<wire::NodeId, double> rows;
  std::map<wire::NodeId, std::vector<Span>> spans;
  std::string parts = scale(kNames, kTimes, height, whole, "ms"), marks;
  for (const auto& [node, name] : names.nodes) {
    rows[node] = kRow * static_cast<double>(rows.size());
    parts += text("row", kNames - 6, rows[node] + 14, name);
  }
  for (const capture::CapturedEvent& event : events) {
    if (rows.count(event.node) == 0) continue;
    const nanoseconds at{event.time_ns};
    const std::string state = state_after(event.what), y = px(rows[event.node] + 3);
    if (!state.empty()) {
      if (!spans[event.node].empty()) spans[event.node].back().ends = at;
      spans[event.node].push_back({state, at, lasted});
    }
    if (event.what.find(" -> ") == std::string::npos)
      marks += "<path class=\"interrupt\" d=\"M" + px(x(at)) + ' ' + y + "l4 7l-4 7l-4 -7Z\"><title>" +
               xml_text(names.of(event.node) + ", " + number(ms(at), 3) + " ms: " + event.what) + "</title></path>";
  }
  for (const auto& [node, of_node] : spans)
    for (const Span& span : of_node)
      if (span.ends > span.begins) parts += state_bar(names.of(node), span, x(span.begins), x(span.ends), rows[node]);
  for (const TimeMark& mark : times)
    marks += "<g><title>" + xml_text(mark.words) + "</title>" + upright("bound", x(mark.at), height) +
             text("axis limit", x(mark.at), height + kBelow + 10, mark.label) + "</g>";
  const double labels = times.empty() ? 0 : 16;
  return svg(kNames + kTimes + kEnd, height + kBelow + labels, "Nodes by state", parts + marks);
}

void write_states(std::ostream& out, const std::string& title, std::istream& capture, const std::string& report,
                  nanoseconds lasted, const std::vector<TimeMark>& marks) {
  capture::PcapngReader reader(capture, title);
  std::vector<capture::CapturedEvent> events;
  while (const auto record = reader.next())
    if (const auto* event = std::get_if<capture::CapturedEvent>(&*record)) events.push_back(*event);
  out << head(title) << "<p>Each row is a node, with its states; a diamond is something else that happened to it"
      << (marks.empty() ? ". Point at either"
                        : "; a dashed line is an event that the cause names. Point at any of them")
      << " for its time.</p>\n<figure>" << states_picture(reader.names(), events, lasted, marks) << "</figure>\n<pre>"
      << xml_text(report) << "</pre>\n</body></html>\n";
}

}  // namespace limb_ring::app
