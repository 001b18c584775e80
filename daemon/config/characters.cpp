#include "config/characters.h"

#include <algorithm>
#include <boost/locale/utf.hpp>

namespace limb_ring::config {

bool are_digits(const std::string& text, std::size_t most) {
  return !text.empty() && text.size() <= most && std::all_of(text.begin(), text.end(), is_digit);
}

bool is_plain_text(const std::string& text) {
  namespace utf = boost::locale::utf;
  for (auto at = text.begin(); at != text.end();) {
    const utf::code_point character = utf::utf_traits<char>::decode(at, text.end());
    const bool control = character < ' ' || (character >= 0x7f && character < 0xa0);
    if (!utf::is_valid_codepoint(character) || control) return false;
  }
  return true;
}

std::string printable(const std::string& text) {
  std::size_t end = std::min<std::size_t>(text.size(), 60);
  const auto goes_on = [&text](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80; };
  while (end > 0 && end < text.size() && goes_on(end)) --end;  // no character is cut in two
  std::string shown = text.substr(0, end);
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7F) c = '?';
  return end < text.size() ? shown + "..." : shown;
}

}  // namespace limb_ring::config
