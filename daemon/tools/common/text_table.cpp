#include "tools/common/text_table.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

namespace limb_ring::app {

namespace {

using Rows = std::vector<std::vector<std::string>>;

std::size_t width_of(const Rows& rows, std::size_t column) {
  std::size_t width = 0;
  for (const auto& row : rows) width = std::max(width, row[column].size());
  return width;
}

bool is_number(const std::string& cell) { return cell.find_first_not_of("0123456789.-+") == std::string::npos; }

bool right_aligned(const Rows& rows, std::size_t column) {
  return std::all_of(rows.begin() + 1, rows.end(), [column](const auto& row) { return is_number(row[column]); });
}

std::string aligned(const std::string& cell, std::size_t width, bool right) {
  const std::string padding(width - cell.size(), ' ');
  return right ? padding + cell : cell + padding;
}

}  // namespace

std::string text_table(const Rows& rows) {
  std::vector<std::string> lines(rows.size());
  for (std::size_t column = 0; !rows.empty() && column < rows.front().size(); ++column) {
    const std::size_t width = width_of(rows, column);
    const bool right = right_aligned(rows, column);
    for (std::size_t row = 0; row < rows.size(); ++row)
      lines[row] += (column == 0 ? "" : "  ") + aligned(rows[row][column], width, right);
  }
  std::string text;
  for (auto& line : lines) text += line.erase(line.find_last_not_of(' ') + 1) + "\n";
  return text;
}

std::string shortened(const std::string& text, std::size_t width) {
  if (text.size() <= width || width < 3) return text.substr(0, width);
  const std::size_t end = (width - 1) / 2;
  return text.substr(0, width - 1 - end) + '~' + text.substr(text.size() - end);
}

std::string wrapped(const std::string& text, std::size_t width) {
  constexpr const char* kIndent = "    ";
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    while (line.size() > width) {
      const std::size_t end = line.rfind(' ', width);
      if (end == std::string::npos || line.find_first_not_of(' ') > end) break;
      out += line.substr(0, end) + '\n';
      line = kIndent + line.substr(end + 1);
    }
    out += line + '\n';
  }
  return out;
}

std::string counted(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + ' ' + noun + (count == 1 ? "" : "s");
}

std::string number(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

}  // namespace limb_ring::app
