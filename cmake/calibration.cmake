# SPDX-License-Identifier: Apache-2.0
# The room `calibration` needs OpenCV (boards in pictures) and Ceres (the joint fit). Without them everything
# else is built, and the verb `calibrate` is not there.
option(TUINA_CALIBRATION "Build the calibration of the scanner, which needs OpenCV and Ceres" ON)
set(TUINA_OPENCV_LIBRARIES "")
if(TUINA_CALIBRATION)
  # Debian's OpenCVConfig.cmake comes with all of OpenCV only; three of its libraries are enough.
  find_path(TUINA_OPENCV_INCLUDE opencv2/calib3d.hpp PATH_SUFFIXES opencv4)
  foreach(part IN ITEMS calib3d imgproc core)
    find_library(TUINA_OPENCV_${part} opencv_${part})
    list(APPEND TUINA_OPENCV_LIBRARIES ${TUINA_OPENCV_${part}})
  endforeach()
  find_package(Ceres 2.1 QUIET)
  if(NOT TUINA_OPENCV_INCLUDE OR TUINA_OPENCV_LIBRARIES MATCHES "NOTFOUND" OR NOT Ceres_FOUND)
    message(STATUS "OpenCV or Ceres is missing: the verb `calibrate` is left out")
    set(TUINA_CALIBRATION OFF)
  endif()
endif()
