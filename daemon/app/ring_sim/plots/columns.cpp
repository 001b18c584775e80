#include "app/ring_sim/plots/columns.h"

namespace limb_ring::ring_sim {

std::string csv_of(const std::vector<Column>& columns) {
  std::string text;
  for (const Column& column : columns) text += (&column == &columns.front() ? "" : ",") + column.name;
  text += '\n';
  for (std::size_t row = 0; row < columns.front().cells.size(); ++row) {
    for (const Column& column : columns) text += (&column == &columns.front() ? "" : ",") + column.cells[row];
    text += '\n';
  }
  return text;
}

void add_point(std::vector<Column>& columns, const std::string& method, const std::string& cell) {
  if (columns.empty() || columns.back().name != method) columns.push_back({method, {}});
  columns.back().cells.push_back(cell);
}

}  // namespace limb_ring::ring_sim
