#pragma once

#include <string>

namespace limb_ring::cli {

/// Text as a man page may hold it: nothing in it means anything to roff.
std::string roff(const std::string& text);

/// A man page of a program, up to where its own sections begin: header, NAME, SYNOPSIS.
/// @param name the program's
/// @param what it is, as a sentence
/// @param usage what may follow its name
std::string man_page_begin(const std::string& name, const std::string& what, const std::string& usage);

/// What is the same in all pages: FILES, SEE ALSO.
std::string man_page_end(const std::string& name);

/// The page of a program that has no more than a text for --help.
/// @param help as it is printed: its first line is "NAME: what it is", then lines to be kept as they are
std::string man_page_of_text(const std::string& name, const std::string& help, const std::string& usage);

}  // namespace limb_ring::cli
