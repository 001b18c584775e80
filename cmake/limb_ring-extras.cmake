# The end of limb_ringConfig.cmake: the target limb_ring::limb_ring, the client library and the formats inside packets
# with their headers, and nothing of ROS. limb_ring_INCLUDE_DIRS and limb_ring_LIBRARIES are there by now; catkin's hold the messages, too.
if(NOT TARGET limb_ring::limb_ring)
  set(limb_ring_own_libraries ${limb_ring_LIBRARIES})
  list(FILTER limb_ring_own_libraries INCLUDE REGEX "limb_ring_(joint_node|client|payload)")
  add_library(limb_ring::limb_ring INTERFACE IMPORTED)
  set_target_properties(limb_ring::limb_ring PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${limb_ring_INCLUDE_DIRS}"
    INTERFACE_LINK_LIBRARIES "${limb_ring_own_libraries}"
    INTERFACE_COMPILE_FEATURES cxx_std_17)
endif()
# There are no components: where one is required, limb_ring is not found.
foreach(limb_ring_component IN LISTS limb_ring_FIND_COMPONENTS)
  if(limb_ring_FIND_REQUIRED_${limb_ring_component})
    set(limb_ring_FOUND FALSE)
    set(limb_ring_NOT_FOUND_MESSAGE "limb_ring has no components, so there is no '${limb_ring_component}' of it.")
  endif()
endforeach()
