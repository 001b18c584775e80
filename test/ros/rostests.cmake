# Tests of the whole: a master, a ring, a bridge. Names are limb_ring's, ports are rostest's.
if(NOT CATKIN_ENABLE_TESTING)
  return()
endif()
find_package(rostest REQUIRED)
find_package(roslaunch REQUIRED)

# ring_rostest(NAME SECONDS [HUMANOID]): test/ros/NAME.test, ended by ctest after so many seconds. Those of a humanoid come
# one after the other: each is some 40 processes at 100 Hz, half a core.
function(ring_rostest name seconds)
  cmake_parse_arguments(arg "HUMANOID" "" "" ${ARGN})
  add_rostest(${name}.test)
  set_tests_properties(_ctest_${PROJECT_NAME}_rostest_test_ros_${name}.test PROPERTIES
    TIMEOUT ${seconds}
    PROCESSORS 2
    COST 90  # they take long, so they begin first
    ENVIRONMENT "ROS_HOME=${PROJECT_BINARY_DIR}/ros_home/${name};LIMB_RING_DATA=${recordings};LIMB_RING_TEST_FILES=${CMAKE_CURRENT_BINARY_DIR}")
  if(arg_HUMANOID)
    set_tests_properties(_ctest_${PROJECT_NAME}_rostest_test_ros_${name}.test PROPERTIES RESOURCE_LOCK humanoid COST 100)
  endif()
endfunction()

# recording_rostest(NAME SECONDS [HUMANOID] RECORDING...): shown as skipped by ctest where the recordings are missing.
function(recording_rostest name seconds)
  cmake_parse_arguments(arg "HUMANOID" "" "" ${ARGN})
  foreach(recording ${arg_UNPARSED_ARGUMENTS})
    if(NOT EXISTS ${recordings}/${recording})
      add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -E echo
        "skipped: ${recordings}/${recording} is missing (set LIMB_RING_DATA and configure again)")
      set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "skipped:")
      return()
    endif()
  endforeach()
  ring_rostest(${name} ${seconds} ${ARGN})
endfunction()

# The humanoid with every CPU an outside process: the tests play the joints. All they send has to arrive, so a machine
# that does not run a process for a while breaks no link.
set_property(DIRECTORY APPEND PROPERTY
  CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/config/humanoid16.yaml)
file(READ ${PROJECT_SOURCE_DIR}/config/humanoid16.yaml humanoid)
string(REPLACE "{command: [limb_firmware], alive_period: 200ms}" "attached" humanoid "${humanoid}")
string(REPLACE "silence: 250ms" "send: 1s\n  silence: 3s" humanoid "${humanoid}")
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/humanoid16_attached.yaml "${humanoid}")

add_executable(walking_recording_test walking_recording_test.cpp)
add_dependencies(tests walking_recording_test)
target_include_directories(walking_recording_test PRIVATE ${PROJECT_SOURCE_DIR}/test)
target_link_libraries(walking_recording_test PRIVATE limb_ring_bridge gmock gtest)

ring_rostest(launch_arguments 660)
ring_rostest(own_firmware 280)
ring_rostest(own_rings 300)
ring_rostest(two_robots 300)
ring_rostest(play_bag 420)
ring_rostest(bringup 300 HUMANOID)
ring_rostest(new_master 240)
ring_rostest(recovery 360 HUMANOID)
ring_rostest(fault 300 HUMANOID)
ring_rostest(diagnostics 360 HUMANOID)
ring_rostest(events 300 HUMANOID)
ring_rostest(view 300 HUMANOID)
ring_rostest(frames 300 HUMANOID)
ring_rostest(simulated_time 240 HUMANOID)
ring_rostest(virtual_clock 180)
ring_rostest(virtual_fault 300 HUMANOID)
ring_rostest(controllers 240)
ring_rostest(follow_clock 240)
ring_rostest(topics 300)
# Not by roslaunch_add_file_check(), which takes whatever Python is first on PATH.
add_test(NAME roslaunch_check COMMAND ${CATKIN_ENV} ${PYTHON_EXECUTABLE} ${roslaunch_DIR}/../scripts/roslaunch-check --ignore-unset-args
         -o ${PROJECT_BINARY_DIR}/roslaunch_check.xml ${PROJECT_SOURCE_DIR}/launch)
set_tests_properties(roslaunch_check PROPERTIES ENVIRONMENT "ROS_HOME=${PROJECT_BINARY_DIR}/ros_home")
# Several hosts by roslaunch's machine tags; says so where there is no SSH server to be had.
add_test(NAME machines COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/machines_test.py)
set_tests_properties(machines PROPERTIES TIMEOUT 180 PROCESSORS 2 RESOURCE_LOCK hosts COST 60 SKIP_REGULAR_EXPRESSION "skipped: "
  ENVIRONMENT "RING_TEST_PROGRAMS=$<TARGET_FILE_DIR:ringd>;PYTHONDONTWRITEBYTECODE=1")
add_test(NAME enter_build COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/enter_build_test.py
         ${CATKIN_DEVEL_PREFIX}/setup.bash)
# Eight seconds of the ring's time, twice.
add_test(NAME virtual_demo COMMAND ${PYTHON_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/virtual_demo --duration 8
         --programs $<TARGET_FILE_DIR:ringd>)
set_tests_properties(virtual_demo PROPERTIES TIMEOUT 300 PROCESSORS 2 RESOURCE_LOCK humanoid COST 100
  ENVIRONMENT "ROS_HOME=${PROJECT_BINARY_DIR}/ros_home;PYTHONDONTWRITEBYTECODE=1;LIMB_RING_DEMO_ENTERED=1")
ring_rostest(scenario 300)
ring_rostest(command_sets 300)
ring_rostest(side_by_side 300)
recording_rostest(walking_recording 300 HUMANOID icub_walking/walking.csv)
recording_rostest(recorded_topics 300 realsense_frames/frames jsk_force_torque)

# Packages that `ringctl new` writes, of an arm, of a quadruped and of a mobile arm with wheels, a lift and a hand (25 nodes) of
# others, built and tested outside the tree.
add_test(NAME new_package COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/new_package.py $<TARGET_FILE:ringctl>
  ${CATKIN_DEVEL_PREFIX} "${CMAKE_PREFIX_PATH}" ${recordings}/robots/ur5_robot.urdf ${recordings}/robots/go2.urdf
  ${recordings}/robots/tiago.urdf)
set_tests_properties(new_package PROPERTIES TIMEOUT 600 COST 90 SKIP_REGULAR_EXPRESSION "skipped: ")
