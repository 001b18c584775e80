#include "tools/common/rows.h"

#include <cmath>
#include <cstdio>

#include "tools/common/text_table.h"

namespace limb_ring::app {

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

}  // namespace limb_ring::app
