# What `cmake --install` writes:
#   --component lefort        the program with its man pages, bash completion, modules for 3D Slicer and examples
#   --component lefort_dev    all layers as a package for others: find_package(lefort) gives lefort::predict, ...
#   --component lefort_field  the distance field alone (cmake/lefort_field_package.cmake); lefort_dev needs it
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

install(TARGETS lefort RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT lefort)
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/lefort/examples COMPONENT lefort
  PATTERN use_* EXCLUDE PATTERN *.py EXCLUDE)

install(DIRECTORY workflow DESTINATION ${CMAKE_INSTALL_DATADIR}/lefort USE_SOURCE_PERMISSIONS COMPONENT lefort)

set(reference ${PROJECT_BINARY_DIR}/reference)
install(DIRECTORY ${reference}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT lefort)
install(DIRECTORY ${reference}/completions
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion COMPONENT lefort)
install(DIRECTORY ${reference}/slicer DESTINATION lib/lefort USE_SOURCE_PERMISSIONS COMPONENT lefort)

# The layers of the field are those of the package lefort_field.
set(others ${LEFORT_LAYERS})
list(REMOVE_ITEM others core geometry field)
set(targets)
foreach(layer IN LISTS others)
  list(APPEND targets lefort_${layer})
  set_target_properties(lefort_${layer} PROPERTIES EXPORT_NAME ${layer})
  install(DIRECTORY src/lefort/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lefort COMPONENT lefort_dev
    FILES_MATCHING PATTERN "*.h" PATTERN internal EXCLUDE)
endforeach()
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/lefort)
install(TARGETS ${targets} EXPORT lefort
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT lefort_dev)
install(EXPORT lefort NAMESPACE lefort:: DESTINATION ${package} COMPONENT lefort_dev)

set(LEFORT_LAYER_TABLE)
foreach(layer IN LISTS LEFORT_LAYERS)
  string(APPEND LEFORT_LAYER_TABLE "set(_lefort_needs_${layer} ${LEFORT_LAYER_${layer}})\n")
endforeach()
string(REPLACE ";" " " LEFORT_LAYER_TABLE "${LEFORT_LAYER_TABLE}")
configure_package_config_file(cmake/lefort-config.cmake.in
  ${PROJECT_BINARY_DIR}/lefort-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lefort-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lefort-config.cmake ${PROJECT_BINARY_DIR}/lefort-config-version.cmake
  DESTINATION ${package} COMPONENT lefort_dev)
