#include "config/xml_text.h"

#include <boost/locale/utf.hpp>

namespace limb_ring::config {

namespace {

using boost::locale::utf::code_point;

constexpr const char* kReplacement = "\xEF\xBF\xBD";  // U+FFFD, in UTF-8

/// What XML 1.0 calls Char. (https://www.w3.org/TR/xml/#charsets)
bool is_allowed(code_point character) {
  if (character < ' ') return character == '\t' || character == '\n' || character == '\r';
  return boost::locale::utf::is_valid_codepoint(character) && character != 0xFFFE && character != 0xFFFF;
}

std::string escaped(const std::string& character) {
  if (character == "&") return "&amp;";
  if (character == "<") return "&lt;";
  if (character == ">") return "&gt;";
  if (character == "\"") return "&quot;";
  return character;
}

}  // namespace

std::string xml_text(const std::string& text) {
  std::string xml;
  for (auto at = text.begin(); at != text.end();) {
    const auto begin = at;
    if (is_allowed(boost::locale::utf::utf_traits<char>::decode(at, text.end()))) {
      xml += escaped({begin, at});
    } else {
      xml += kReplacement;
      at = begin + 1;  // what was read with it may be a character of its own
    }
  }
  return xml;
}

}  // namespace limb_ring::config
