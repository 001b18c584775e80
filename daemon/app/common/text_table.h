#pragma once

#include <string>
#include <vector>

namespace limb_ring::app {

/// Rows with aligned columns, two spaces between them; the first row is the heading. Columns
/// whose cells below the heading all are numbers or '-' are aligned to the right.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

/// A number for people: as many decimals as given.
std::string number(double value, int decimals = 1);

}  // namespace limb_ring::app
