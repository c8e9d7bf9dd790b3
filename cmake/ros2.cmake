# SPDX-License-Identifier: Apache-2.0
# The room `ros2` talks through Cyclone DDS (Debian: cyclonedds-dev). Without it everything else is built, and the
# option `--ros2` says that this build has none. Messages go to it as bytes, through the interface that Cyclone
# offers to the middleware of ROS 2 and changes with its releases, hence the versions.
option(TUINA_ROS2 "Publish sessions to ROS 2, which needs Cyclone DDS 0.10" ON)
if(TUINA_ROS2)
  find_package(CycloneDDS 0.10 QUIET)
  if(NOT CycloneDDS_FOUND OR NOT CycloneDDS_VERSION VERSION_LESS 0.11)
    message(STATUS "Cyclone DDS 0.10 is missing: the option `--ros2` is left out")
    set(TUINA_ROS2 OFF)
  endif()
endif()
