# Configures, builds and runs project/ in a fresh folder, against the build or an install of it. The
# folder is not below the package: an install there would be a second limb_ring to roslaunch.
function(fail why)
  file(REMOVE_RECURSE ${SCRATCH})
  message(FATAL_ERROR "${why}")
endfunction()

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    fail("failed (${result}): ${ARGV}")
  endif()
endfunction()

execute_process(COMMAND mktemp -d OUTPUT_VARIABLE SCRATCH OUTPUT_STRIP_TRAILING_WHITESPACE)
file(MAKE_DIRECTORY ${SCRATCH}/runtime)
set(prefix ${DEVEL})
if(INSTALL)
  set(prefix ${SCRATCH}/prefix)
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
endif()
string(REPLACE ";" ":" SEARCH_PATH "${SEARCH}")
if(SANITIZE)
  set(flags -fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/project -B ${SCRATCH}/build
  "-DCMAKE_PREFIX_PATH=${prefix};${SEARCH}" -DCMAKE_CXX_COMPILER=${COMPILER}
  -DCMAKE_CXX_FLAGS=${flags} -DPYTHON_EXECUTABLE=${PYTHON} -DECHO_CPU=${PROJECT_SOURCE}/examples/echo_cpu.cpp)
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)

# There are no components: one that is required is not found, and named.
file(WRITE ${SCRATCH}/components/CMakeLists.txt
  "cmake_minimum_required(VERSION 3.16)\nproject(components LANGUAGES CXX)\n"
  "find_package(limb_ring REQUIRED OPTIONAL_COMPONENTS any COMPONENTS nonsense)\n")
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SCRATCH}/components -B ${SCRATCH}/components/build "-DCMAKE_PREFIX_PATH=${prefix};${SEARCH}"
          -DCMAKE_CXX_COMPILER=${COMPILER} -DPYTHON_EXECUTABLE=${PYTHON}
  RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE said)
if(result EQUAL 0 OR NOT said MATCHES "there is no 'nonsense' of it")
  fail("a component that does not exist: ended with ${result} and said: ${said}")
endif()

# Without a ring the example has to say so.
execute_process(
  COMMAND ${CMAKE_COMMAND} -E env XDG_RUNTIME_DIR=${SCRATCH}/runtime
          ${SCRATCH}/build/echo_cpu nowhere 3
  RESULT_VARIABLE result ERROR_VARIABLE said)
if(NOT result EQUAL 1 OR NOT said MATCHES "nowhere/3.host")
  fail("echo_cpu without a ring ended with ${result} and said: ${said}")
endif()

# The firmware of the tutorial, as it stands there, on a live ring.
# And the package limb_ring for Python, with the CPUs in Python and the tests that the tutorial prints.
set(python_path PYTHONPATH=${prefix}/lib/python3/dist-packages:$ENV{PYTHONPATH})
run(${CMAKE_COMMAND} -E env "CMAKE_PREFIX_PATH=${prefix}:${SEARCH_PATH}" CXX=${COMPILER} CXXFLAGS=${flags} ${python_path}
  PYTHON_EXECUTABLE=${PYTHON} XDG_RUNTIME_DIR=${SCRATCH}/runtime
  ${PYTHON} ${CMAKE_CURRENT_LIST_DIR}/tutorial_firmware.py
  ${PROJECT_SOURCE} ${prefix}/lib/limb_ring ${SCRATCH}/tutorial)
run(${CMAKE_COMMAND} -E env ${python_path} PYTHONDONTWRITEBYTECODE=1 LIMB_RING_TUTORIAL=${PROJECT_SOURCE}/docs/tutorial/6_test_it.md
  ${PYTHON} -m pytest -q -p no:cacheprovider ${PROJECT_SOURCE}/test/python/tutorial_test.py)
file(REMOVE_RECURSE ${SCRATCH})
