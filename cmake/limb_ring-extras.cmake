# The end of limb_ringConfig.cmake: the target limb_ring::limb_ring, the client library with its headers, and
# nothing of ROS. limb_ring_INCLUDE_DIRS and limb_ring_LIBRARIES are there by now; catkin's hold the messages, too.
if(NOT TARGET limb_ring::limb_ring)
  set(limb_ring_client_library ${limb_ring_LIBRARIES})
  list(FILTER limb_ring_client_library INCLUDE REGEX "limb_ring_client")
  add_library(limb_ring::limb_ring INTERFACE IMPORTED)
  set_target_properties(limb_ring::limb_ring PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${limb_ring_INCLUDE_DIRS}"
    INTERFACE_LINK_LIBRARIES "${limb_ring_client_library}"
    INTERFACE_COMPILE_FEATURES cxx_std_17)
endif()
