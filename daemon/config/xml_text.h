#pragma once

#include <string>

namespace limb_ring::config {

/// `text` as it may stand in XML, in an attribute or between tags.
std::string xml_text(const std::string& text);

}  // namespace limb_ring::config
