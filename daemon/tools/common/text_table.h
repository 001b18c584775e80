#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace limb_ring::app {

/// Rows with aligned columns, two spaces between them; the first row is the heading. Columns
/// whose cells below the heading all are numbers or '-' are aligned to the right.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

/// The text cut to `width` columns: its beginning and its end, with '~' between, since similar names differ at either
/// end.
std::string shortened(const std::string& text, std::size_t width);

/// Breaks lines between words so that they fit into `width` columns, unless a word is longer. Continued lines are
/// indented.
std::string wrapped(const std::string& text, std::size_t width);

/// "1 daemon", "2 daemons": a noun whose plural has an s.
std::string counted(std::uint64_t count, const std::string& noun);

/// A number for people: as many decimals as given.
std::string number(double value, int decimals = 1);

}  // namespace limb_ring::app
