# SPDX-License-Identifier: Apache-2.0
# cmake --install gives find_package(tuina): one target per room, and tuina::tuina for all of them; with COMPONENTS
# shared all of these are libtuina.so. pkg-config knows that as `tuina`, and the static libraries as `tuina-static`.
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

set(in_cmake DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tuina COMPONENT dev)
install(TARGETS ${targets} EXPORT tuina ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
install(TARGETS tuina_shared EXPORT tuina_shared
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT dev)
install(EXPORT tuina_shared NAMESPACE tuina:: FILE tuinaSharedTargets.cmake ${in_cmake})
# Looked up when it is installed, since any header may have been changed since.
install(CODE "
  include(${PROJECT_SOURCE_DIR}/cmake/public_headers.cmake)
  tuina_public_headers(${PROJECT_SOURCE_DIR} headers)
  foreach(header IN LISTS headers)
    cmake_path(GET header PARENT_PATH folder)
    file(INSTALL ${PROJECT_SOURCE_DIR}/\${header} DESTINATION \${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/\${folder})
  endforeach()" COMPONENT dev)
install(EXPORT tuina NAMESPACE tuina:: FILE tuinaTargets.cmake ${in_cmake})
install(DIRECTORY models config DESTINATION ${CMAKE_INSTALL_DATADIR}/tuina COMPONENT tuina)
install(TARGETS tuina_app tuina_evaluate DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tuina)

# The program itself says how shells complete it and what man(1) shows.
set(said ${PROJECT_BINARY_DIR}/said)
file(MAKE_DIRECTORY ${said})
add_custom_command(OUTPUT ${said}/tuina ${said}/_tuina ${said}/tuina.fish ${said}/tuina.1.gz ${said}/tuina-evaluate.1.gz
  COMMAND tuina_app completion bash > ${said}/tuina
  COMMAND tuina_app completion zsh > ${said}/_tuina
  COMMAND tuina_app completion fish > ${said}/tuina.fish
  COMMAND tuina_app manual > ${said}/tuina.1
  COMMAND ${CMAKE_COMMAND} -E echo ".so man1/tuina.1" > ${said}/tuina-evaluate.1
  COMMAND gzip -9nf ${said}/tuina.1 ${said}/tuina-evaluate.1
  DEPENDS tuina_app VERBATIM)
add_custom_target(tuina_said ALL DEPENDS ${said}/tuina.1.gz)
set(completion ${CMAKE_INSTALL_DATADIR})
install(FILES ${said}/tuina DESTINATION ${completion}/bash-completion/completions COMPONENT tuina)
install(FILES ${said}/_tuina DESTINATION ${completion}/zsh/vendor-completions COMPONENT tuina)
install(FILES ${said}/tuina.fish DESTINATION ${completion}/fish/vendor_completions.d COMPONENT tuina)
install(FILES ${said}/tuina.1.gz ${said}/tuina-evaluate.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tuina)
list(JOIN TUINA_ROOMS " " shown_rooms)
configure_package_config_file(cmake/tuinaConfig.cmake.in ${PROJECT_BINARY_DIR}/tuinaConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tuina)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tuinaConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tuinaConfig.cmake ${PROJECT_BINARY_DIR}/tuinaConfigVersion.cmake ${in_cmake})

# What pkg-config says. Static libraries need by name whatever is hidden in them.
set(static_libraries "")
set(hidden_libraries "-ltomlplusplus -lembree3 -lmujoco -lcivetweb -lpthread")
set(hidden_packages "tinyxml2 libpng libjpeg zlib sqlite3 libpq libarchive libzstd libssl libcrypto")
foreach(target IN LISTS targets)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    string(APPEND static_libraries " -l${target}")
  endif()
endforeach()
if(TUINA_CALIBRATION)
  string(APPEND hidden_libraries " -lceres -lglog -lopencv_calib3d -lopencv_imgproc -lopencv_core")
endif()
if(TUINA_ROS2)
  string(APPEND hidden_packages " CycloneDDS")
endif()
file(RELATIVE_PATH up_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
foreach(package IN ITEMS tuina tuina-static)
  configure_file(cmake/${package}.pc.in ${PROJECT_BINARY_DIR}/${package}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${package}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()
