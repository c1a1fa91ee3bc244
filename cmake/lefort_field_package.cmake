# The distance field alone, as a package for others: find_package(lefort_field) gives lefort::field.
# It needs Eigen, fmt, tl::expected and TBB, none of the imaging and meshing libraries.
#   cmake --install build/release --component lefort_field --prefix /where/ever
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/lefort_field)
foreach(layer options core geometry field)
  set_target_properties(lefort_${layer} PROPERTIES EXPORT_NAME ${layer})
endforeach()
install(TARGETS lefort_options lefort_core lefort_geometry lefort_field EXPORT lefort_field
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT lefort_field)
foreach(layer core geometry field)
  install(DIRECTORY src/lefort/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lefort COMPONENT lefort_field
    FILES_MATCHING PATTERN "*.h" PATTERN internal EXCLUDE)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/lefort/core/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lefort/core COMPONENT lefort_field)
install(EXPORT lefort_field NAMESPACE lefort:: DESTINATION ${package} COMPONENT lefort_field)
configure_package_config_file(cmake/lefort_field-config.cmake.in
  ${PROJECT_BINARY_DIR}/lefort_field-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lefort_field-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lefort_field-config.cmake
  ${PROJECT_BINARY_DIR}/lefort_field-config-version.cmake
  DESTINATION ${package} COMPONENT lefort_field)
