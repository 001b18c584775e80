#pragma once

#include "config/ring_config.h"
#include "io/agreement.h"

namespace limb_ring::setup {

/// What all nodes of a ring must agree on, out of its file (protocol.md section 6.13). Not in it, since it may differ
/// from host to host: transport, addresses and ports, `limits`, `realtime`, `firmware`, `bridge`, the commands of CPUs,
/// and waits that concern one node alone.
link::Agreement agreement_of(const config::RingConfig& ring);

}  // namespace limb_ring::setup
