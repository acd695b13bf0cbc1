# Unit tests of the ROS layer and the rostests. Registered with ctest itself: catkin's run_tests passes when tests fail.
enable_testing()
find_package(GTest REQUIRED)
if(NOT TARGET tests)
  add_custom_target(tests)
endif()

file(GLOB ros_unit_tests CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test/unit/ros/test_*.cpp)
list(REMOVE_ITEM ros_unit_tests ${CMAKE_CURRENT_SOURCE_DIR}/test/unit/ros/test_fault_table.cpp)
add_executable(test_ros_layer EXCLUDE_FROM_ALL ${ros_unit_tests})
set_source_files_properties(test/unit/ros/test_corrupt_bag.cpp PROPERTIES
  COMPILE_DEFINITIONS CORRUPT_BAG="$<TARGET_FILE:corrupt_bag>")
target_link_libraries(test_ros_layer multicam_egomotion_bag_runner multicam_egomotion_fault_injection GTest::GTest
  GTest::Main)
precompile_headers(ros_libraries test_ros_layer)
set_target_properties(test_ros_layer PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test)
add_test(NAME test_ros_layer COMMAND test_ros_layer WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
add_dependencies(test_ros_layer corrupt_bag)
add_dependencies(tests test_ros_layer)

# What each fault of the data does to the odometry, one row a fault.
add_executable(test_fault_table EXCLUDE_FROM_ALL test/unit/ros/test_fault_table.cpp)
target_link_libraries(test_fault_table multicam_egomotion_bag_runner multicam_egomotion_fault_injection
  multicam_egomotion_simulator GTest::GTest GTest::Main)
precompile_headers(ros_libraries test_fault_table)
set_target_properties(test_fault_table PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test)
set(replay_rate)  # each has its own default
set(rostest_timeout 240)
set(live_alone FALSE)
if(MULTICAM_EGOMOTION_SANITIZE)
  set(replay_rate rate:=0.1)
  set(rostest_timeout 600)
  set(live_alone TRUE)
endif()
# Each in two parts that run at the same time.
foreach(recording simulated recorded)
  foreach(part 0 1)
    set(name test_fault_table_${recording}_${part})
    add_test(NAME ${name} COMMAND test_fault_table --gtest_filter=${recording}/*
      WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    set_tests_properties(${name} PROPERTIES TIMEOUT ${unit_test_timeout} COST 50
      ENVIRONMENT "GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=${part}" SKIP_REGULAR_EXPRESSION "  SKIPPED ")
  endforeach()
endforeach()
add_dependencies(tests test_fault_table)

# Executables where rostest looks for those of the package.
foreach(name test_nodelet_manager test_replay test_services)
  add_executable(${name} EXCLUDE_FROM_ALL test/rostest/${name}.cpp)
  target_link_libraries(${name} multicam_egomotion_ros GTest::GTest)
  precompile_headers(ros_libraries ${name})
  add_dependencies(tests ${name})
endforeach()
add_dependencies(tests multicam_egomotion_nodelet ${ros_tools})

set(run_rostest ${CATKIN_DEVEL_PREFIX}/env.sh python3 ${CMAKE_CURRENT_SOURCE_DIR}/cmake/run_rostest.py)
set(recordings ${CMAKE_BINARY_DIR}/test/recordings)
file(MAKE_DIRECTORY ${recordings})

function(add_ros_test name file)
  add_test(NAME rostest_${name} COMMAND ${run_rostest} ${name} ${CMAKE_CURRENT_SOURCE_DIR}/test/rostest/${file}
    ${CMAKE_BINARY_DIR}/test/rostest/${name} ${ARGN})
  # One at a time; they mostly wait, so they start first and run beside the others, if they are not slow themselves.
  set_tests_properties(rostest_${name} PROPERTIES TIMEOUT ${rostest_timeout} SKIP_RETURN_CODE 77 RESOURCE_LOCK ros
    COST 100 RUN_SERIAL ${live_alone})
endfunction()

# A simulated recording, made when the tests run.
set(simulated ${recordings}/handheld_stereo)
add_test(NAME recording_simulated COMMAND egomotion_sim handheld_stereo ${simulated}.bag --duration 4)
set_tests_properties(recording_simulated PROPERTIES FIXTURES_SETUP simulated TIMEOUT 300 COST 200)
add_ros_test(replay_simulated replay.test bag:=${simulated}.bag rig:=${simulated}.rig.yaml max_error:=0.05
  ${replay_rate})
add_ros_test(topics_only topics_only.test bag:=${simulated}.bag)
add_ros_test(bag_loop bag_loop.test bag:=${simulated}.bag rig:=${simulated}.rig.yaml ${replay_rate})
add_ros_test(nodelet_manager nodelet_manager.test bag:=${simulated}.bag rig:=${simulated}.rig.yaml ${replay_rate})
add_ros_test(live_faults live_faults.test bag:=${simulated}.bag rig:=${simulated}.rig.yaml ${replay_rate})
set_tests_properties(rostest_live_faults PROPERTIES TIMEOUT 600)  # with as many signals as one likes
add_test(NAME test_egomotion_bag COMMAND ${PYTHON_EXECUTABLE}
  ${CMAKE_CURRENT_SOURCE_DIR}/test/unit/ros/test_egomotion_bag.py $<TARGET_FILE:egomotion_bag> ${simulated})
add_test(NAME test_wrong_rigs COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/test/unit/ros/test_wrong_rigs.py
  $<TARGET_FILE:egomotion_bag> $<TARGET_FILE:egomotion_sim>)
set_tests_properties(rostest_replay_simulated rostest_topics_only rostest_bag_loop
  rostest_nodelet_manager rostest_live_faults test_egomotion_bag PROPERTIES FIXTURES_REQUIRED simulated)

# A real one, where the data are.
if(DEFINED ENV{MULTICAM_EGOMOTION_DATA})
  set(data $ENV{MULTICAM_EGOMOTION_DATA})
else()
  get_filename_component(data ${CMAKE_CURRENT_SOURCE_DIR}/../shared/data ABSOLUTE)
endif()
set(euroc ${data}/euroc_mh01_excerpt/mav0)
set(euroc_bag ${recordings}/euroc_mh01)
add_ros_test(replay_euroc replay.test --needs ${euroc_bag}.bag bag:=${euroc_bag}.bag rig:=${euroc_bag}.rig.yaml
  max_error:=0.05 ${replay_rate})
if(EXISTS ${euroc})
  add_test(NAME recording_euroc
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scripts/euroc_to_bag.py ${euroc} ${euroc_bag}.bag)
  set_tests_properties(recording_euroc PROPERTIES FIXTURES_SETUP euroc TIMEOUT 120 COST 200)
  set_tests_properties(rostest_replay_euroc PROPERTIES FIXTURES_REQUIRED euroc)
endif()
