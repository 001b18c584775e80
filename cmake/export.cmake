# What catkin_package() does with ROS, for who has none: find_package(limb_ring) from the build and from an install.
include(CMakePackageConfigHelpers)
function(limb_ring_export prefix include output)
  set(export_include ${include})
  set(export_joint_node ${prefix}/${LIMB_RING_LIB}/liblimb_ring_joint_node.a)
  set(export_client ${prefix}/${LIMB_RING_LIB}/liblimb_ring_client.a)
  set(export_payload ${prefix}/${LIMB_RING_LIB}/liblimb_ring_payload.a)
  configure_package_config_file(cmake/limb_ringConfig.cmake.in ${output}/limb_ringConfig.cmake
    INSTALL_DESTINATION ${prefix}/${LIMB_RING_SHARE}/cmake INSTALL_PREFIX ${prefix}
    PATH_VARS export_include export_joint_node export_client export_payload)
  write_basic_package_version_file(${output}/limb_ringConfig-version.cmake
    VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
  configure_file(cmake/limb_ring-extras.cmake ${output}/limb_ring-extras.cmake COPYONLY)
endfunction()

# Into share/limb_ring/cmake.
function(limb_ring_install_config)
  limb_ring_export(${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_PREFIX}/include
    ${PROJECT_BINARY_DIR}/install_config)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/install_config/ DESTINATION ${LIMB_RING_SHARE}/cmake)
endfunction()
