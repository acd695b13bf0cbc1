# Installs the solver library as multicam_egomotion::solvers, for find_package(multicam_egomotion). Component: solvers.
include(CheckCXXSourceCompiles)
include(CMakePackageConfigHelpers)

# Eigen aligns by the instruction set, so that a consumer compiled for another one would see other layouts of the same
# types: the alignment of this build goes with the target.
if(MULTICAM_EGOMOTION_NATIVE)
  set(CMAKE_REQUIRED_FLAGS -march=native)
endif()
foreach(set AVX512F AVX)
  unset(MULTICAM_EGOMOTION_HAS_${set} CACHE)  # compiler flags may have changed
  check_cxx_source_compiles("
    #ifndef __${set}__
    #error absent
    #endif
    int main() {}" MULTICAM_EGOMOTION_HAS_${set})
endforeach()
unset(CMAKE_REQUIRED_FLAGS)
if(MULTICAM_EGOMOTION_HAS_AVX512F)
  set(MULTICAM_EGOMOTION_EIGEN_ALIGNMENT 64)
elseif(MULTICAM_EGOMOTION_HAS_AVX)
  set(MULTICAM_EGOMOTION_EIGEN_ALIGNMENT 32)
else()
  set(MULTICAM_EGOMOTION_EIGEN_ALIGNMENT 16)
endif()
target_compile_definitions(multicam_egomotion_solvers INTERFACE
  $<INSTALL_INTERFACE:EIGEN_MAX_ALIGN_BYTES=${MULTICAM_EGOMOTION_EIGEN_ALIGNMENT}>)

set_target_properties(multicam_egomotion_solvers PROPERTIES EXPORT_NAME solvers)
install(TARGETS multicam_egomotion_solvers EXPORT multicam_egomotionTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT solvers
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT solvers
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT solvers)
foreach(layer geometry solvers estimation)
  install(DIRECTORY include/multicam_egomotion/${layer} DESTINATION include/multicam_egomotion COMPONENT solvers)
endforeach()

if(MULTICAM_EGOMOTION_ROS)
  # Beside catkin's configuration, in the devel space too.
  set(config_directory ${CATKIN_PACKAGE_SHARE_DESTINATION}/cmake)
  export(EXPORT multicam_egomotionTargets NAMESPACE multicam_egomotion::
    FILE ${CATKIN_DEVEL_PREFIX}/${config_directory}/multicam_egomotionTargets.cmake)
else()
  set(config_directory ${CMAKE_INSTALL_LIBDIR}/cmake/multicam_egomotion)
  configure_file(cmake/multicam_egomotion-solvers.cmake.in multicam_egomotionConfig.cmake @ONLY)
  write_basic_package_version_file(multicam_egomotionConfigVersion.cmake COMPATIBILITY SameMajorVersion)
  #catkin_lint: ignore_once missing_file wrong_install_destination
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/multicam_egomotionConfig.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/multicam_egomotionConfigVersion.cmake
    DESTINATION ${config_directory} COMPONENT solvers)
endif()
install(EXPORT multicam_egomotionTargets NAMESPACE multicam_egomotion:: DESTINATION ${config_directory}
  COMPONENT solvers)
