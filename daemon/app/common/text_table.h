#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace limb_ring::app {

/// Rows with aligned columns, two spaces between them; the first row is the heading. Columns
/// whose cells below the heading all are numbers or '-' are aligned to the right.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

/// As much of a text as `width` columns hold: its begin and its end, with '~' between. Names that belong together
/// differ at either end.
std::string shortened(const std::string& text, std::size_t width);

/// Lines broken between words so that they fit, as far as words do; what goes on is indented.
std::string wrapped(const std::string& text, std::size_t width);

/// "1 daemon", "2 daemons": a noun whose plural has an s.
std::string counted(std::uint64_t count, const std::string& noun);

/// A number for people: as many decimals as given.
std::string number(double value, int decimals = 1);

}  // namespace limb_ring::app
