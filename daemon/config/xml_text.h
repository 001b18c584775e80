#pragma once

#include <string>

namespace limb_ring::config {

/// `text` as it may stand in XML, in an attribute or between tags. Whatever it holds: each byte that XML does not
/// allow, or that is no UTF-8, is U+FFFD.
std::string xml_text(const std::string& text);

}  // namespace limb_ring::config
