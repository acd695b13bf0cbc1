# Executables that need no ROS.
layer_sources(paper_experiments_sources tools/paper_experiments)
add_executable(paper_experiments src/tools/paper_experiments.cpp ${paper_experiments_sources})
target_link_libraries(paper_experiments multicam_egomotion_simulator opencv_imgcodecs boost_program_options)

if(MULTICAM_EGOMOTION_ROS)
  install(TARGETS paper_experiments RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
else()
  install(TARGETS paper_experiments RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
