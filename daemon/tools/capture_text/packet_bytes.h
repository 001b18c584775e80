#pragma once

#include "limb_ring/captured_packet.h"
#include "wire/packet.h"

namespace limb_ring::app {

/// What was captured of a packet, as the wire's functions take it; valid as long as `packet`.
inline wire::ByteView bytes_of(const CapturedPacket& packet) { return {packet.bytes.data(), packet.bytes.size()}; }
inline wire::PacketFields fields_of(const CapturedPacket& packet) { return {bytes_of(packet)}; }

}  // namespace limb_ring::app
