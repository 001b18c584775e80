# What a user gets, beside the programs whose own folders install them. Programs lie where
# roslaunch and rosrun look for a package's own; those that people type are on PATH, too.
foreach(program ringd ring_sim echo_cpu joint_cpu)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${LIMB_RING_BIN})
  endif()
endforeach()
# Where the links are made they lead nowhere, and have other names: roslaunch takes what has a program's name.
file(REMOVE_RECURSE ${PROJECT_BINARY_DIR}/bin)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/links)
foreach(program ringd ringctl ring_sim compare_networks limb_firmware)
  file(CREATE_LINK ../${LIMB_RING_BIN}/${program} ${PROJECT_BINARY_DIR}/links/${program}.link SYMBOLIC)
  install(FILES ${PROJECT_BINARY_DIR}/links/${program}.link DESTINATION bin RENAME ${program})
  install(FILES completion/limb_ring.bash DESTINATION share/bash-completion/completions RENAME ${program})
endforeach()
install(TARGETS limb_ring_joint_node limb_ring_client limb_ring_payload ARCHIVE DESTINATION ${LIMB_RING_LIB})
install(DIRECTORY include/limb_ring/ DESTINATION ${LIMB_RING_INCLUDE})
install(PROGRAMS examples/walk_controller.py DESTINATION ${LIMB_RING_BIN})
install(DIRECTORY config examples urdf web wireshark DESTINATION ${LIMB_RING_SHARE} PATTERN playground EXCLUDE)
# What ringctl serves, where it looks for it from its own folder.
get_filename_component(share ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/../../share/limb_ring ABSOLUTE)
file(MAKE_DIRECTORY ${share})
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/web ${share}/web SYMBOLIC)
install(FILES docs/test_vectors.json DESTINATION ${LIMB_RING_SHARE})
# Scenarios name their rings' files from where they are, which is one folder less here.
file(GLOB_RECURSE scenarios CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/test test/scenarios/*.yaml)
foreach(scenario ${scenarios})
  file(READ test/${scenario} text)
  string(REPLACE "../../config/" "../config/" text "${text}")
  file(WRITE ${PROJECT_BINARY_DIR}/${scenario} "${text}")
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/scenarios DESTINATION ${LIMB_RING_SHARE})
if(LIMB_RING_ROS)
  install(DIRECTORY launch rviz DESTINATION ${LIMB_RING_SHARE})
endif()

# For whom pkg-config finds libraries. Paths are from where the file lies: a prefix can be moved.
file(RELATIVE_PATH LIMB_RING_PC_PREFIX /${LIMB_RING_LIB}/pkgconfig /)
configure_file(cmake/limb_ring.pc.in ${PROJECT_BINARY_DIR}/limb_ring.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/limb_ring.pc DESTINATION ${LIMB_RING_LIB}/pkgconfig)

# `systemctl --user start limb-ring@leg8`; share/ is where systemd looks below ~/.local and /usr/local, too.
set(LIMB_RING_SYSTEMD_USER share/systemd/user CACHE STRING "Folder of systemd's user units, below the prefix")
install(CODE "
  set(LIMB_RING_BIN_FOLDER \"\${CMAKE_INSTALL_PREFIX}/bin\")
  configure_file(\"${PROJECT_SOURCE_DIR}/systemd/limb-ring@.service.in\" \"${PROJECT_BINARY_DIR}/limb-ring@.service\" @ONLY)
  file(INSTALL \"${PROJECT_BINARY_DIR}/limb-ring@.service\"
       DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${LIMB_RING_SYSTEMD_USER}\")")

if(NOT TARGET uninstall)
  add_custom_target(uninstall COMMAND ${CMAKE_COMMAND} -D MANIFEST=${PROJECT_BINARY_DIR}/install_manifest.txt
    -P ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake)
endif()
