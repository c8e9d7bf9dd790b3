# SPDX-License-Identifier: Apache-2.0
# `cpack` makes two Debian packages: tuina (programs, atlas, completion, manual) and libtuina-dev (headers, libraries,
# CMake package). Libraries of other packages that tuina needs are found by dpkg-shlibdeps.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tuina)
set(CPACK_PACKAGE_CONTACT "tuina developers <tuina@tuina.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "robot massage: laser scan, acupoints, trajectories, force control")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL tuina dev)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

set(CPACK_DEBIAN_TUINA_PACKAGE_NAME tuina)
set(CPACK_DEBIAN_TUINA_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_TUINA_DESCRIPTION "The programs tuina and tuina-evaluate with the shipped atlas.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libtuina-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION "Headers, static libraries and the CMake package of tuina.")
# What its headers and libraries need is what packages.txt names, without the tools of a build.
file(STRINGS packages.txt needed REGEX "-dev$")
list(JOIN needed ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)
include(CPack)
