#pragma once

#include <string>

namespace limb_ring::config {

/// Every entry of a ring's file with default, what is allowed, and meaning, as Markdown: what
/// `ringd --options` prints, and config/OPTIONS.md.
std::string options_markdown();

}  // namespace limb_ring::config
