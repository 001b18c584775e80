#pragma once

#include <string>

namespace limb_ring::process {

/// Tells systemd that this process is ready, where it was started as a service of Type=notify (NOTIFY_SOCKET is set);
/// else nothing. As sd_notify(3) has it, whose library this spares us.
/// @param status a line for `systemctl status`
void tell_ready(const std::string& status);

}  // namespace limb_ring::process
