# What ROS conventions ask for: messages, the exported client library, the devel space.
# catkin keeps the tests' environment as it is now, without folders that do not exist yet: a fresh
# build's tests would find no Python messages.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/devel/lib/python3/dist-packages)
# rosrun looks for programs below the package, but leaves out build/ there, which is where we build by default.
if(PROJECT_BINARY_DIR STREQUAL ${PROJECT_SOURCE_DIR}/build)
  file(CREATE_LINK build/devel ${PROJECT_SOURCE_DIR}/devel RESULT ignored SYMBOLIC)
endif()
find_package(catkin REQUIRED COMPONENTS
  roscpp rosgraph_msgs sensor_msgs geometry_msgs std_msgs topic_tools message_generation diagnostic_msgs
  diagnostic_updater visualization_msgs tf2_ros)
file(GLOB msg_files CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/msg msg/*.msg)
file(GLOB srv_files CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/srv srv/*.srv)
add_message_files(FILES ${msg_files})
add_service_files(FILES ${srv_files})
generate_messages(DEPENDENCIES std_msgs sensor_msgs)
catkin_package(
  INCLUDE_DIRS include
  LIBRARIES limb_ring_joint_node limb_ring_client limb_ring_payload
  CFG_EXTRAS limb_ring-extras.cmake
  SKIP_PKG_CONFIG_GENERATION  # ours asks for nothing of ROS
  CATKIN_DEPENDS message_runtime roscpp sensor_msgs geometry_msgs std_msgs topic_tools)
set(LIMB_RING_DEVEL ${CATKIN_DEVEL_PREFIX})
set(LIMB_RING_BIN ${CATKIN_PACKAGE_BIN_DESTINATION})
set(LIMB_RING_LIB ${CATKIN_PACKAGE_LIB_DESTINATION})
set(LIMB_RING_INCLUDE ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
set(LIMB_RING_SHARE ${CATKIN_PACKAGE_SHARE_DESTINATION})
set(LIMB_RING_PYTHON ${CATKIN_GLOBAL_PYTHON_DESTINATION})
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
# Debian's catkin puts its configuration into lib/TRIPLET for packages, and CMake looks there first. Then there is room for
# one in share/ that finds the client library if the ROS package is not installed.
if(NOT CATKIN_GLOBAL_LIB_DESTINATION STREQUAL lib)
  include(cmake/export.cmake)
  # The catkin of Debian 11 uses share/, too. Ours replaces its file there, and includes it under another name if it finds it.
  if(catkin_VERSION VERSION_LESS 0.8.10)
    install(CODE "set(ENV{CMAKE_INSTALL_ALWAYS} 1)")  # CMake does not replace a file that is less than a second older
    install(FILES ${PROJECT_BINARY_DIR}/catkin_generated/installspace/limb_ringConfig.cmake
      DESTINATION ${LIMB_RING_SHARE}/cmake RENAME limb_ring-catkin.cmake)
  endif()
  limb_ring_install_config()
endif()
