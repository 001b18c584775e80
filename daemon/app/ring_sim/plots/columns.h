#pragma once

#include <string>
#include <vector>

namespace limb_ring::ring_sim {

/// A column of a picture's figures.
struct Column {
  std::string name;  ///< without commas and quotes
  std::vector<std::string> cells;
};

/// As CSV with a heading. @pre all columns have the same number of cells
std::string csv_of(const std::vector<Column>& columns);

/// Adds a point of a method's curve: to the last column where it is that method's, else to a new one.
void add_point(std::vector<Column>& columns, const std::string& method, const std::string& cell);

}  // namespace limb_ring::ring_sim
