# SPDX-License-Identifier: Apache-2.0
# Builds the robots of models/robots into the robot room, so they are found by name wherever the binary
# stands. The file's stem is the name.
set(TUINA_ROBOTS
  thesis
  successor
  panda
  ur
)
set(TUINA_SHIPPED_ROBOTS "")
foreach(robot IN LISTS TUINA_ROBOTS)
  set(file ${PROJECT_SOURCE_DIR}/models/robots/${robot}.toml)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(APPEND TUINA_SHIPPED_ROBOTS "      {\"${robot}\", R\"toml(${text})toml\"},\n")
endforeach()
set(TUINA_SHIPPED_ROBOTS_CPP ${PROJECT_BINARY_DIR}/generated/shipped_robots.cpp)
configure_file(${PROJECT_SOURCE_DIR}/tuina/robot/table/shipped_robots.cpp.in
  ${TUINA_SHIPPED_ROBOTS_CPP} @ONLY)
