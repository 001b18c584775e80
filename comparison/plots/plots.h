#pragma once

#include <string>

#include "comparison/plots/picture.h"

namespace limb_ring::comparison {

/// Where the pictures go, and who draws them.
class PlotFolder {
 public:
  /// Makes the folder, and those above it, where they are missing.
  /// @throw ring_sim::UsageError where it cannot be made, or written into; std::runtime_error where gnuplot is missing
  explicit PlotFolder(const std::string& path);

  /// Writes <name>.csv and <name>.gp, and lets gnuplot draw <name>.png and <name>.svg.
  /// @throw ring_sim::UsageError where a file cannot be written; std::runtime_error where gnuplot fails
  void draw(const Picture& picture) const;

 private:
  void write(const std::string& name, const std::string& text) const;

  std::string path_, gnuplot_;
};

/// Measures and draws all pictures; says on standard error which.
void draw_all(const PlotFolder& folder, const PlotInput& input);

}  // namespace limb_ring::comparison
