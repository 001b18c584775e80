#pragma once

#include <string_view>

namespace limb_ring::app {

/// roslaunch adds `__name:=...` and `__log:=...` to a program's arguments, which are for ROS nodes alone.
inline bool from_roslaunch(std::string_view argument) {
  return argument.substr(0, 2) == "__" && argument.find(":=") != std::string_view::npos;
}

}  // namespace limb_ring::app
