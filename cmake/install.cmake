# SPDX-License-Identifier: Apache-2.0
# cmake --install gives find_package(tuina): one target per room, and tuina::tuina for all of them.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

add_library(tuina_tuina INTERFACE)
add_library(tuina::tuina ALIAS tuina_tuina)
set_target_properties(tuina_tuina PROPERTIES EXPORT_NAME tuina)
set(targets tuina_tuina)
foreach(room IN LISTS TUINA_ROOMS)
  target_link_libraries(tuina_tuina INTERFACE tuina_${room})
  list(APPEND targets tuina_${room})
endforeach()

install(TARGETS ${targets} EXPORT tuina ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY tuina/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tuina FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY models config DESTINATION ${CMAKE_INSTALL_DATADIR}/tuina OPTIONAL)
install(TARGETS tuina_app tuina_evaluate DESTINATION ${CMAKE_INSTALL_BINDIR})
install(EXPORT tuina NAMESPACE tuina:: FILE tuinaTargets.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tuina)
configure_package_config_file(cmake/tuinaConfig.cmake.in ${PROJECT_BINARY_DIR}/tuinaConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tuina)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tuinaConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tuinaConfig.cmake ${PROJECT_BINARY_DIR}/tuinaConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tuina)
