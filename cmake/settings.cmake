# Compiler settings shared by everything below daemon/, ros_bridge/ and test/.
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
add_compile_options(-Wall -Wextra -Wpedantic -Wshadow $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>)
if(LIMB_RING_SANITIZE)
  add_compile_options(-fsanitize=${LIMB_RING_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${LIMB_RING_SANITIZE})
endif()
if(LIMB_RING_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# Optimised as a whole where a program is linked (GCC): a hop is many small functions in many files,
# and a fifth of its time goes into calling them.
function(limb_ring_whole_program target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_BUILD_TYPE STREQUAL Release AND NOT LIMB_RING_SANITIZE)
    set(flto -flto)
    if(CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 10)
      set(flto -flto=auto)
    endif()
    target_compile_options(${target} PRIVATE ${flto} -ffat-lto-objects)
  endif()
endfunction()

# Linked without that, which takes 10 s for each program: no packet waits for ringctl or a test, and those of a daemon wait
# for the kernel most of all, and gain 1 to 2 % by it.
function(limb_ring_plain_link target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_link_libraries(${target} PRIVATE -fno-use-linker-plugin)
  endif()
endfunction()

# A program of which a ring runs one process a node. At a fixed address (no PIE) the branches that the processor has learned
# in one of them serve in all: with the nodes on one core, up to a quarter of the round trip. Only the program's own code is
# at an address that is known; libraries, heap and stack stay where the kernel puts them.
function(limb_ring_one_a_node target)
  if(NOT LIMB_RING_SANITIZE AND NOT LIMB_RING_FUZZ)
    target_link_libraries(${target} PRIVATE -no-pie)
  endif()
endfunction()

# What is not in the way of a packet: a third less to compile (-O1: a fifth). Release builds alone; elsewhere the build type
# says it.
function(limb_ring_cold target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og>)
endfunction()

# Most of a build's time goes into reading other people's headers, so each target reads them once: its files are compiled
# together (a unity build). There is no other way: nobody would notice what compiles in one of two ways alone.
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 0)  # all in one
set(CMAKE_OPTIMIZE_DEPENDENCIES ON)  # libraries wait for none but generated files (CMake 3.19; before: for each other)
