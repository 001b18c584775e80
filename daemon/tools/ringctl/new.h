#pragma once

#include <string>
#include <utility>
#include <vector>

namespace limb_ring::ringctl {

/// A node of a ring that `ringctl new` writes.
struct NewNode {
  std::string name;
  std::vector<std::string> joints;                ///< as the URDF has them
  std::vector<std::string> cpu{"limb_firmware"};  ///< program and arguments
};

struct NewRing {
  std::string name, robot;
  std::string urdf;            ///< from the folder of the ring's file
  std::string package;         ///< empty: none
  double rate = 100;           ///< Hz
  std::vector<NewNode> nodes;  ///< without the body
};

/// The first nodes get programs of the package as their CPUs: one in C++, and where there are two nodes, one in Python.
void give_own_firmware(NewRing& ring);
/// All files of the package but the ring's and the URDF: path and text.
std::vector<std::pair<std::string, std::string>> package_files(const NewRing& ring);
/// What to type next.
std::string next_of(const NewRing& ring);

}  // namespace limb_ring::ringctl
