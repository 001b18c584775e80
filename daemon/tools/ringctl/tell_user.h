#pragma once

#include <chrono>
#include <string>

namespace limb_ring::ringctl {

/// A line on standard error, for who has called ringctl: "ringctl: WHAT".
void tell_user(const std::string& what);
/// The same of a process::Standstill; nothing where it is 0.
void tell_standstill(std::chrono::nanoseconds time);

}  // namespace limb_ring::ringctl
