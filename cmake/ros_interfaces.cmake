# Messages, services, live parameters and what other packages see of this one.
add_message_files(DIRECTORY msg FILES CalibratedCamera.msg Calibration.msg EgoMotion.msg)
add_service_files(DIRECTORY srv FILES SetPose.srv)
generate_messages(DEPENDENCIES geometry_msgs std_msgs)

generate_dynamic_reconfigure_options(cfg/EgoMotion.cfg)

catkin_package(
  INCLUDE_DIRS include
  LIBRARIES multicam_egomotion_solvers multicam_egomotion_core multicam_egomotion_ros
  CATKIN_DEPENDS cv_bridge diagnostic_updater dynamic_reconfigure geometry_msgs image_transport message_runtime nav_msgs
    nodelet pluginlib rosbag roscpp sensor_msgs std_msgs std_srvs tf2 tf2_eigen tf2_msgs tf2_ros
  DEPENDS EIGEN3 OpenCV
  CFG_EXTRAS multicam_egomotion-solvers.cmake)
