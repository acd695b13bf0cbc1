# ROS tests
