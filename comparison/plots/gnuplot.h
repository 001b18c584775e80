#pragma once

#include <chrono>
#include <string>

namespace limb_ring::comparison {

/// Path of gnuplot. @throw std::runtime_error where there is none; says what to install
std::string find_gnuplot();

/// Lets gnuplot draw `script`, a file in `folder`; what it reads and writes are names in that folder.
/// No shell sees a name.
/// @param gnuplot as find_gnuplot() gives it
/// @throw std::runtime_error where it cannot be started, fails, or takes longer than `limit`, with its
///        last words
void run_gnuplot(const std::string& gnuplot, const std::string& folder, const std::string& script,
                 std::chrono::milliseconds limit);

}  // namespace limb_ring::comparison
