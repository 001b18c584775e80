# The same layout without ROS: for the core's own tests, sanitizers, and machines without ROS.
set(LIMB_RING_BIN lib/limb_ring)
set(LIMB_RING_LIB lib)
set(LIMB_RING_INCLUDE include/limb_ring)
set(LIMB_RING_SHARE share/limb_ring)
set(LIMB_RING_PYTHON lib/python3/dist-packages)
set(LIMB_RING_DEVEL ${PROJECT_BINARY_DIR}/devel)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${LIMB_RING_DEVEL}/${LIMB_RING_BIN})
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${LIMB_RING_DEVEL}/${LIMB_RING_LIB})

# What catkin_package() does with ROS: find_package(limb_ring) from the build and from an install.
include(CMakePackageConfigHelpers)
function(limb_ring_export prefix include output)
  set(export_include ${include})
  set(export_client ${prefix}/${LIMB_RING_LIB}/liblimb_ring_client.a)
  set(export_payload ${prefix}/${LIMB_RING_LIB}/liblimb_ring_payload.a)
  configure_package_config_file(cmake/limb_ringConfig.cmake.in ${output}/limb_ringConfig.cmake
    INSTALL_DESTINATION ${prefix}/${LIMB_RING_SHARE}/cmake INSTALL_PREFIX ${prefix}
    PATH_VARS export_include export_client export_payload)
  write_basic_package_version_file(${output}/limb_ringConfig-version.cmake
    VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
  configure_file(cmake/limb_ring-extras.cmake ${output}/limb_ring-extras.cmake COPYONLY)
endfunction()
limb_ring_export(${LIMB_RING_DEVEL} ${PROJECT_SOURCE_DIR}/include
  ${LIMB_RING_DEVEL}/${LIMB_RING_SHARE}/cmake)
limb_ring_export(${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_PREFIX}/include
  ${PROJECT_BINARY_DIR}/install_config)
install(DIRECTORY ${PROJECT_BINARY_DIR}/install_config/ DESTINATION ${LIMB_RING_SHARE}/cmake)
