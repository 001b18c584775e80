# Everything a user gets. Programs lie where roslaunch and rosrun look for a package's own.
foreach(program ringd ringctl limb_firmware ring_sim ring_bridge echo_cpu)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${LIMB_RING_BIN})
  endif()
endforeach()
install(TARGETS limb_ring_client ARCHIVE DESTINATION ${LIMB_RING_LIB})
install(DIRECTORY include/limb_ring/ DESTINATION ${LIMB_RING_INCLUDE})
install(DIRECTORY config launch DESTINATION ${LIMB_RING_SHARE})
