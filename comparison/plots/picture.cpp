#include "comparison/plots/picture.h"

#include <sstream>

#include "study/model_ring.h"
#include "tools/common/text_table.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::comparison {

namespace {

constexpr int kPicoseconds = 6;  // decimals of a us

}  // namespace

std::string us(study::Duration duration) { return app::number(study::microseconds(duration), kPicoseconds); }

std::string rate_of(const study::Medium& medium) { return ring_sim::megabits(medium.rate) + " Mbit/s"; }

std::string figures_of(const study::ComparisonOptions& options) {
  return figures_of(options, std::to_string(options.medium.nodes), rate_of(options.medium));
}

std::string figures_of(const study::ComparisonOptions& options, const std::string& nodes, const std::string& rate) {
  std::ostringstream text;
  text << "N = " << nodes << ", B = " << options.medium.payload << " bytes, R = " << rate
       << ", d = " << study::microseconds(options.medium.relay_delay) << " us, seed " << options.seed;
  return text.str();
}

std::string title(const std::string& first, const std::string& second) {
  return "set title \"" + first + "\\n" + second + "\"\n";
}

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

}  // namespace limb_ring::comparison
