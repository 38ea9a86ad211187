# Install tree: program, library, public headers under include/planish/, CMake package, JSON schemas.
include(CMakePackageConfigHelpers)
install(TARGETS planish EXPORT planishTargets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/planish)
install(TARGETS planish_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(EXPORT planishTargets NAMESPACE planish:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/planish)
configure_package_config_file(cmake/planishConfig.cmake.in planishConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/planish)
write_basic_package_version_file(planishConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/planishConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/planishConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/planish)
install(FILES docs/report.schema.json docs/diagnosis.schema.json docs/verify.schema.json
        DESTINATION ${CMAKE_INSTALL_DATADIR}/planish)
