#pragma once

#include "client/connection.h"

namespace limb_ring::client {

/// Finds the daemon's socket (options, environment, the only ring running), connects, greets.
/// Goes on trying until `deadline` while the daemon is not there yet.
/// @throw HostPortError
Connection open_connection(const ConnectOptions& options, Clock::time_point deadline);

}  // namespace limb_ring::client
