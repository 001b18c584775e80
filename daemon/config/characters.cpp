#include "config/characters.h"

#include <boost/locale/utf.hpp>

namespace limb_ring::config {

bool is_plain_text(const std::string& text) {
  namespace utf = boost::locale::utf;
  for (auto at = text.begin(); at != text.end();) {
    const utf::code_point character = utf::utf_traits<char>::decode(at, text.end());
    const bool control = character < ' ' || (character >= 0x7f && character < 0xa0);
    if (!utf::is_valid_codepoint(character) || control) return false;
  }
  return true;
}

}  // namespace limb_ring::config
