#pragma once

#include <string>

namespace limb_ring::app {

/// The word as a shell reads it back, whatever is in it: in quotes where it needs them.
std::string shell_word(const std::string& word);

}  // namespace limb_ring::app
