# Python module multicam_egomotion_solvers (pybind11, numpy). Not multicam_egomotion: that is the package of the messages.
if(NOT pybind11_FOUND)
  message(FATAL_ERROR "MULTICAM_EGOMOTION_PYTHON is ON, found no pybind11, expected version 2.6 or later")
endif()
file(GLOB python_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/python/*.cpp)
add_library(multicam_egomotion_python MODULE ${python_sources})
target_link_libraries(multicam_egomotion_python PRIVATE multicam_egomotion_solvers pybind11::module)
pybind11_extension(multicam_egomotion_python)
set_target_properties(multicam_egomotion_python PROPERTIES OUTPUT_NAME multicam_egomotion_solvers
  CXX_VISIBILITY_PRESET hidden LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/python INSTALL_RPATH "$ORIGIN/../..")
install(TARGETS multicam_egomotion_python DESTINATION lib/python3/dist-packages)
