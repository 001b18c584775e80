# What a user gets, beside the programs whose own folders install them. Programs lie where
# roslaunch and rosrun look for a package's own.
foreach(program ringd ring_sim echo_cpu joint_cpu)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${LIMB_RING_BIN})
  endif()
endforeach()
install(TARGETS limb_ring_client limb_ring_payload ARCHIVE DESTINATION ${LIMB_RING_LIB})
install(DIRECTORY include/limb_ring/ DESTINATION ${LIMB_RING_INCLUDE})
foreach(program ringctl ringd ring_sim limb_firmware)
  install(FILES completion/limb_ring.bash DESTINATION share/bash-completion/completions RENAME ${program})
endforeach()
install(PROGRAMS examples/walk_controller.py DESTINATION ${LIMB_RING_BIN})
install(DIRECTORY config examples launch rviz urdf DESTINATION ${LIMB_RING_SHARE})
