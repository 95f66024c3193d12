# find_package(pentaprism) gives the target pentaprism::pentaprism and the headers in <pentaprism/...>.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pentaprism)

install(TARGETS pentaprism_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS pentaprism EXPORT pentaprism_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/pentaprism DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT pentaprism_targets FILE pentaprismTargets.cmake NAMESPACE pentaprism:: DESTINATION ${package_dir})

configure_package_config_file(cmake/pentaprismConfig.cmake.in ${PROJECT_BINARY_DIR}/pentaprismConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pentaprismConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pentaprismConfig.cmake ${PROJECT_BINARY_DIR}/pentaprismConfigVersion.cmake
        DESTINATION ${package_dir})
