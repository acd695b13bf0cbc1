# The ROS library, nodelet, node and bag tools, and everything that is installed for them.
layer_sources(ros_sources ros)
# The message that it includes has the name of a class that the others use.
set_source_files_properties(src/ros/ego_motion_message.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
add_library(multicam_egomotion_ros ${ros_sources})
add_dependencies(multicam_egomotion_ros ${${PROJECT_NAME}_EXPORTED_TARGETS} ${catkin_EXPORTED_TARGETS})
target_include_directories(multicam_egomotion_ros SYSTEM PUBLIC ${catkin_INCLUDE_DIRS} ${YAML_CPP_INCLUDE_DIR})
target_link_libraries(multicam_egomotion_ros
  PUBLIC multicam_egomotion_core ${catkin_LIBRARIES} opencv_imgcodecs PRIVATE ${YAML_CPP_LIBRARIES})
set(ros_headers <map> <string> <vector> <Eigen/Geometry> <image_transport/image_transport.h> <nav_msgs/Odometry.h>
  <opencv2/core.hpp> <ros/ros.h> <rosbag/bag.h> <rosbag/view.h> <sensor_msgs/CameraInfo.h> <sensor_msgs/Image.h>
  <sensor_msgs/Imu.h> <tf2_msgs/TFMessage.h> <tf2_ros/transform_listener.h>)
precompile_headers(ros_libraries multicam_egomotion_ros ${ros_headers})

add_library(multicam_egomotion_nodelet src/ros/nodelet/ego_motion_nodelet.cpp)
target_link_libraries(multicam_egomotion_nodelet multicam_egomotion_ros)
precompile_headers(ros_libraries multicam_egomotion_nodelet)

add_executable(egomotion_node src/tools/egomotion_node.cpp)
target_include_directories(egomotion_node PRIVATE src/tools)
target_link_libraries(egomotion_node multicam_egomotion_ros)
precompile_headers(ros_libraries egomotion_node)

layer_sources(bag_runner_sources tools/bag_runner)
add_library(multicam_egomotion_bag_runner STATIC ${bag_runner_sources})
target_include_directories(multicam_egomotion_bag_runner PUBLIC src/tools)
target_link_libraries(multicam_egomotion_bag_runner PUBLIC multicam_egomotion_ros PRIVATE boost_program_options)
precompile_headers(ros_libraries multicam_egomotion_bag_runner)
add_executable(egomotion_bag src/tools/egomotion_bag.cpp)
target_link_libraries(egomotion_bag multicam_egomotion_bag_runner)
precompile_headers(ros_libraries egomotion_bag)

layer_sources(fault_injection_sources tools/fault_injection)
add_library(multicam_egomotion_fault_injection STATIC ${fault_injection_sources})
target_include_directories(multicam_egomotion_fault_injection PUBLIC src/tools)
target_include_directories(multicam_egomotion_fault_injection SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(multicam_egomotion_fault_injection
  PUBLIC multicam_egomotion_core ${catkin_LIBRARIES} opencv_imgcodecs)
precompile_headers(ros_libraries multicam_egomotion_fault_injection)
add_executable(corrupt_bag src/tools/corrupt_bag.cpp)
target_link_libraries(corrupt_bag multicam_egomotion_fault_injection boost_program_options)
precompile_headers(ros_libraries corrupt_bag)

add_executable(egomotion_sim src/tools/egomotion_sim.cpp)
target_include_directories(egomotion_sim SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(egomotion_sim multicam_egomotion_simulator ${catkin_LIBRARIES} boost_program_options)
precompile_headers(ros_libraries egomotion_sim)
set(ros_tools egomotion_node egomotion_bag corrupt_bag egomotion_sim)

install(TARGETS multicam_egomotion_ros multicam_egomotion_nodelet
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(TARGETS ${ros_tools} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES nodelet_plugins.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(DIRECTORY launch config DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

# Scripts stand beside the modules that they import.
catkin_install_python(PROGRAMS scripts/euroc_to_bag.py scripts/kitti_to_bag.py scripts/evaluate.py scripts/wrong_rigs.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
file(GLOB script_modules CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/scripts/*.py)
list(FILTER script_modules EXCLUDE REGEX "/(euroc_to_bag|kitti_to_bag|evaluate|wrong_rigs).py$")
install(FILES ${script_modules} DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})

if(MULTICAM_EGOMOTION_TESTS)
  include(cmake/ros_tests.cmake)
endif()
