# The same layout without ROS: for the core's own tests, sanitizers, and machines without ROS.
set(LIMB_RING_BIN lib/limb_ring)
set(LIMB_RING_LIB lib)
set(LIMB_RING_INCLUDE include/limb_ring)
set(LIMB_RING_SHARE share/limb_ring)
set(LIMB_RING_PYTHON lib/python3/dist-packages)
set(LIMB_RING_DEVEL ${PROJECT_BINARY_DIR}/devel)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${LIMB_RING_DEVEL}/${LIMB_RING_BIN})
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${LIMB_RING_DEVEL}/${LIMB_RING_LIB})

include(cmake/export.cmake)
limb_ring_export(${LIMB_RING_DEVEL} ${PROJECT_SOURCE_DIR}/include
  ${LIMB_RING_DEVEL}/${LIMB_RING_SHARE}/cmake)
limb_ring_install_config()
