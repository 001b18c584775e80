#pragma once

#include <string>

#include "wire/pcapng_writer.h"

namespace limb_ring::app {

/// What is in a data packet of that channel, in words; empty where nobody here knows.
std::string payload_words(std::uint8_t channel, wire::ByteView data, const capture::RingNames& names);

/// "01 02 ff"
std::string hex_words(wire::ByteView data);

}  // namespace limb_ring::app
