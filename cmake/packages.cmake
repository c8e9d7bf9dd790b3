# SPDX-License-Identifier: Apache-2.0
# `cpack` makes Debian packages: tuina (programs, atlas, completion, manual), tuina-udev (rules for devices), libtuina0.1
# (the shared library), libtuina-dev (headers, static libraries, CMake package, pkg-config) and, where `import tuina` is
# built, python3-tuina. Libraries of other packages that they need are found by dpkg-shlibdeps.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tuina)
set(CPACK_PACKAGE_CONTACT "tuina developers <tuina@tuina.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "robot massage: laser scan, acupoints, trajectories, force control")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL tuina udev library dev)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

set(CPACK_DEBIAN_TUINA_PACKAGE_NAME tuina)
set(CPACK_DEBIAN_TUINA_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TUINA_PACKAGE_RECOMMENDS tuina-udev)
set(CPACK_COMPONENT_TUINA_DESCRIPTION "The programs tuina and tuina-evaluate with the shipped atlas.")

set(CPACK_DEBIAN_UDEV_PACKAGE_NAME tuina-udev)
set(CPACK_DEBIAN_UDEV_PACKAGE_ARCHITECTURE all)
set(CPACK_COMPONENT_UDEV_DESCRIPTION "Rules of udev: the scanner's board and servos for whoever is logged in.")
install(FILES cmake/debian/60-tuina.rules DESTINATION lib/udev/rules.d COMPONENT udev)

# Several versions of a library may be installed beside each other, so its package is named by its soname.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libtuina${soversion})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
file(WRITE ${PROJECT_BINARY_DIR}/debian/shlibs "libtuina ${soversion} libtuina${soversion} (>= ${PROJECT_VERSION})\n")
file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${PROJECT_BINARY_DIR}/debian/shlibs;${PROJECT_BINARY_DIR}/debian/triggers")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS tuina)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "The shared library of tuina; atlas and robots come with the package tuina.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libtuina-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION "Headers, static libraries, CMake package and pkg-config of tuina.")
# Public headers show three packages, and who links the shared library needs no more. Who links the static ones needs
# whatever packages.txt names, without the tools of a build.
set(shown libeigen3-dev libexpected-dev libfmt-dev)
file(STRINGS packages.txt hidden REGEX "-dev$")
list(REMOVE_ITEM hidden ${shown})
if(TUINA_ROS2)
  list(APPEND hidden cyclonedds-dev)
endif()
list(JOIN hidden ", " CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS)
list(JOIN shown ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)
string(APPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ", libtuina${soversion} (= ${PROJECT_VERSION})")

if(TARGET tuina_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-tuina)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  # A compiled module is for one version of Python; the atlas comes with the programs.
  math(EXPR next_minor "${TUINA_PYTHON_MINOR} + 1")
  string(JOIN ", " CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "tuina (= ${PROJECT_VERSION})" python3-numpy
    "python3 (>= 3.${TUINA_PYTHON_MINOR})" "python3 (<< 3.${next_minor})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-matplotlib)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    "${PROJECT_SOURCE_DIR}/cmake/debian/postinst;${PROJECT_SOURCE_DIR}/cmake/debian/prerm")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "The library from Python, and tuina.simulation: a world without hardware.")
endif()

# What Debian wants of every package: whose it is, and what has changed, in its own form.
find_program(GZIP gzip REQUIRED)
string(TIMESTAMP packed "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${PROJECT_BINARY_DIR}/debian/changelog "tuina (${PROJECT_VERSION}) unstable; urgency=medium\n\n"
  "  * What has changed stands in CHANGELOG.md of the sources.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${packed}\n")
string(TIMESTAMP year "%Y" UTC)
configure_file(cmake/debian/copyright ${PROJECT_BINARY_DIR}/debian/copyright @ONLY)
execute_process(COMMAND ${GZIP} -9nkf changelog WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/debian COMMAND_ERROR_IS_FATAL ANY)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  install(FILES ${PROJECT_BINARY_DIR}/debian/copyright ${PROJECT_BINARY_DIR}/debian/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME} COMPONENT ${component})
endforeach()
include(CPack)
