#include "tools/common/text_table.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
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

namespace {

/// Picoseconds of a time in us, at most 6 decimals, no trailing zeros.
std::string real(double value) {
  if (value != 0 && std::abs(value) < 1e-6) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
  }
  std::string text = number(value, 6);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string cell(const Row& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return real(value.get<double>());
  return value.dump();
}

std::vector<std::string> heading(const Row& row) {
  std::vector<std::string> names;
  for (const auto& [name, value] : row.items()) names.push_back(name);
  return names;
}

std::vector<std::vector<std::string>> cells(const std::vector<Row>& rows) {
  std::vector<std::vector<std::string>> out{heading(rows.front())};
  for (const Row& row : rows) {
    out.emplace_back();
    for (const auto& [name, value] : row.items()) out.back().push_back(cell(value));
  }
  return out;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::string csv(const std::vector<std::vector<std::string>>& table) {
  std::string out;
  for (const auto& row : table)
    for (std::size_t i = 0; i < row.size(); ++i)
      out += quoted(row[i] == "-" ? "" : row[i]) + (i + 1 < row.size() ? "," : "\n");
  return out;
}

}  // namespace

std::string format_rows(const std::vector<Row>& rows, Format format) {
  // A path may be any bytes; JSON is UTF-8.
  if (format == Format::json)
    return Row(rows).dump(2, ' ', /*ensure_ascii=*/false, Row::error_handler_t::replace) + "\n";
  if (rows.empty()) return "";
  return format == Format::csv ? csv(cells(rows)) : text_table(cells(rows));
}

bool colour_wanted(int file) {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool refused =
      (no_colour != nullptr && *no_colour != '\0') || (terminal != nullptr && std::strcmp(terminal, "dumb") == 0);
  return !refused && ::isatty(file) == 1;
}

namespace {

/// Means nothing else to a shell, wherever it stands.
constexpr const char* kPlainCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";

}  // namespace

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(kPlainCharacters) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace limb_ring::app
