#pragma once

#include <chrono>
#include <string>

#include "comparison/pictures.h"

namespace limb_ring::comparison {

/// Path of gnuplot. @throw std::runtime_error if it is not installed; says what to install
std::string find_gnuplot();

/// Lets gnuplot draw `script`, a file in `folder`; what it reads and writes are names in that folder.
/// No shell sees a name.
/// @param gnuplot as find_gnuplot() gives it
/// @throw std::runtime_error if it cannot be started, fails, or takes longer than `limit`, with its
///        last words
void run_gnuplot(const std::string& gnuplot, const std::string& folder, const std::string& script,
                 std::chrono::milliseconds limit);

/// Where the pictures go, and who draws them.
class PlotFolder {
 public:
  /// Makes the folder, and those above it, where they are missing.
  /// @throw ring_sim::UsageError if it cannot be made, or written into; std::runtime_error if gnuplot is missing
  explicit PlotFolder(const std::string& path);

  /// Writes <name>.csv and <name>.gp, and lets gnuplot draw <name>.png and <name>.svg.
  /// @throw ring_sim::UsageError if a file cannot be written; std::runtime_error if gnuplot fails
  void draw(const Picture& picture) const;

 private:
  void write(const std::string& name, const std::string& text) const;

  std::string path_, gnuplot_;
};

/// Measures and draws all pictures; says on standard error which.
void draw_all(const PlotFolder& folder, const PlotInput& input);

}  // namespace limb_ring::comparison
