# The same layout without ROS: for the core's own tests, sanitizers, and machines without ROS.
set(LIMB_RING_BIN lib/limb_ring)
set(LIMB_RING_LIB lib)
set(LIMB_RING_INCLUDE include/limb_ring)
set(LIMB_RING_SHARE share/limb_ring)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/devel/lib/limb_ring)
