# Unit tests (test/unit/LAYER/test_*.cpp, one executable a layer) and style checks. Target `tests` builds them all,
# `benchmarks` the benchmarks.
enable_testing()
find_package(GTest REQUIRED)
find_package(benchmark QUIET)
include(GoogleTest)

if(NOT TARGET tests)
  add_custom_target(tests)
endif()

function(add_test_executable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test/unit)
  target_link_libraries(${name} ${ARG_LIBRARIES} GTest::GTest GTest::Main)
  target_compile_options(${name} PRIVATE -O1)  # compiles faster, and what counts is in the libraries
  precompile_headers(unit_tests ${name} <algorithm> <cmath> <iostream> <map> <random> <string> <vector> <Eigen/Cholesky>
    <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/SVD> <gtest/gtest.h>)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test)
  add_dependencies(tests ${name})
endfunction()

# One ctest entry a test: a skipped one is named, and hides no failure of its neighbours. A suite that shares a costly
# set-up has an executable of its own, and is one entry.
function(add_unit_tests layer)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test/unit/${layer}/test_*.cpp)
  foreach(source ${sources})
    file(STRINGS ${source} shared_set_up REGEX "SetUpTestSuite")
    if(shared_set_up)
      list(REMOVE_ITEM sources ${source})
      get_filename_component(name ${source} NAME_WE)
      add_test_executable(${name} SOURCES ${source} LIBRARIES ${ARGN})
      add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
      set_tests_properties(${name} PROPERTIES TIMEOUT ${unit_test_timeout})
    endif()
  endforeach()
  add_test_executable(test_${layer} SOURCES ${sources} LIBRARIES ${ARGN})
  gtest_discover_tests(test_${layer} TEST_PREFIX test_${layer}. WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
    DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT ${unit_test_timeout} SKIP_REGULAR_EXPRESSION "  SKIPPED ")
endfunction()

function(add_style_check name)
  add_test(NAME style_${name} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test/style/${ARGN})
  set_tests_properties(style_${name} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 120)
endfunction()

# A project outside of this one that uses the solver library, built and run.
function(add_consumer_test name)
  set(directory ${CMAKE_BINARY_DIR}/test/${name})
  add_test(NAME ${name}
    COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${CMAKE_CURRENT_SOURCE_DIR}/test/consumer ${directory}
      --build-generator ${CMAKE_GENERATOR} --build-noclean --build-options -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} ${ARGN}
      --test-command ${directory}/consumer)
  set_tests_properties(${name} PROPERTIES TIMEOUT 300)
endfunction()

if(MULTICAM_EGOMOTION_ROS)
  add_consumer_test(consumer_catkin -Dmulticam_egomotion_DIR=${CATKIN_DEVEL_PREFIX}/share/multicam_egomotion/cmake)

  if(MULTICAM_EGOMOTION_CORE_BUILD)
    set(paper_experiments ${MULTICAM_EGOMOTION_CORE_BUILD}/paper_experiments)
  else()
    set(paper_experiments $<TARGET_FILE:paper_experiments>)
  endif()
  # The Python tools read and write bags. unittest says "OK (skipped=...)" only where nothing failed.
  file(GLOB script_tests CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test/unit/test_scripts_*.py)
  foreach(file ${script_tests})
    get_filename_component(name ${file} NAME_WE)
    add_test(NAME ${name} COMMAND ${PYTHON_EXECUTABLE} -m unittest -v ${name}
      WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/test/unit)
    set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "OK .skipped=" TIMEOUT 600
      ENVIRONMENT PAPER_EXPERIMENTS=${paper_experiments})
  endforeach()
endif()

if(MULTICAM_EGOMOTION_CORE_BUILD)
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${MULTICAM_EGOMOTION_CORE_BUILD}/CTestTestfile.cmake)
  return()
endif()

add_style_check(clang_format check_format.sh)
add_style_check(catkin_lint check_catkin_lint.sh)
add_style_check(layers check_layers.py)

# Tests of solvers and estimation need Eigen only; the others may use the whole core and the simulator.
foreach(layer solvers estimation)
  add_unit_tests(${layer} multicam_egomotion_solvers)
endforeach()
set_target_properties(test_solvers PROPERTIES UNITY_BUILD OFF)  # each file names its solvers alike
if(NOT MULTICAM_EGOMOTION_CORE_ONLY)
  add_unit_tests(geometry multicam_egomotion_simulator opencv_calib3d)
  # Apart from the layers, for reading images loads a hundred libraries.
  add_unit_tests(recordings multicam_egomotion_simulator opencv_imgcodecs ${YAML_CPP_LIBRARIES})
  foreach(layer odometry imu tracking simulator)
    add_unit_tests(${layer} multicam_egomotion_simulator)
  endforeach()
endif()

# Examples check what they show.
file(GLOB examples CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/examples/*.cpp)
foreach(file ${examples})
  get_filename_component(name ${file} NAME_WE)
  add_executable(example_${name} EXCLUDE_FROM_ALL ${file})
  target_link_libraries(example_${name} multicam_egomotion_solvers)
  set_target_properties(example_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test)
  add_test(NAME example_${name} COMMAND example_${name})
  add_dependencies(tests example_${name})
endforeach()

if(MULTICAM_EGOMOTION_PYTHON)
  add_test(NAME python_module COMMAND ${PYTHON_EXECUTABLE} -m unittest -v test_python_module
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/test/unit)
  add_test(NAME example_python COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/examples/relative_pose.py)
  set_tests_properties(python_module example_python PROPERTIES TIMEOUT 120
    ENVIRONMENT PYTHONPATH=${CMAKE_BINARY_DIR}/python)
  add_dependencies(tests multicam_egomotion_python)
endif()

# The consumer project against an installation in a scratch directory.
set(prefix ${CMAKE_BINARY_DIR}/test/prefix)
add_test(NAME install_solvers COMMAND ${CMAKE_COMMAND} --install ${CMAKE_BINARY_DIR} --component solvers --prefix ${prefix})
add_consumer_test(consumer_install -DCMAKE_PREFIX_PATH=${prefix})
set_tests_properties(install_solvers PROPERTIES FIXTURES_SETUP installed TIMEOUT 60)
set_tests_properties(consumer_install PROPERTIES FIXTURES_REQUIRED installed)

# Long runs, by hand or by test_long.sh.
if(NOT MULTICAM_EGOMOTION_CORE_ONLY)
  file(GLOB soaks CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test/soak/*.cpp)
  foreach(file ${soaks})
    get_filename_component(name ${file} NAME_WE)
    add_executable(${name} EXCLUDE_FROM_ALL ${file})
    target_link_libraries(${name} multicam_egomotion_simulator)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test)
  endforeach()
endif()

if(benchmark_FOUND)
  add_custom_target(benchmarks)
  # Those of solvers and estimation need Eigen only.
  file(GLOB benchmarks CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test/benchmark/*_benchmark.cpp)
  if(MULTICAM_EGOMOTION_CORE_ONLY)
    list(FILTER benchmarks INCLUDE REGEX "/(solver|ransac)_benchmark\\.cpp$")
  endif()
  foreach(file ${benchmarks})
    get_filename_component(name ${file} NAME_WE)
    add_executable(${name} EXCLUDE_FROM_ALL ${file})
    target_link_libraries(${name} multicam_egomotion_solvers benchmark::benchmark)
    if(NOT MULTICAM_EGOMOTION_CORE_ONLY)
      target_link_libraries(${name} multicam_egomotion_core)
    endif()
    add_dependencies(benchmarks ${name})
  endforeach()
  # Beside ours, where it is installed and its types are laid out as those of this build.
  find_package(opengv QUIET)
  if(opengv_FOUND AND MULTICAM_EGOMOTION_EIGEN_ALIGNMENT EQUAL 16)
    target_sources(solver_benchmark PRIVATE test/benchmark/opengv_solvers.cpp)
    target_link_libraries(solver_benchmark opengv)
    set_target_properties(solver_benchmark PROPERTIES UNITY_BUILD OFF)  # each file names its problems alike
  endif()
endif()
