# find_package(pentaprism) gives the target pentaprism::pentaprism and the headers in <pentaprism/...>.
include(CMakePackageConfigHelpers)
install(TARGETS pentaprism pentaprism_cli
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/pentaprism DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
