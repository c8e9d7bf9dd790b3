# SPDX-License-Identifier: Apache-2.0
# Builds the programmes of config/programmes into the massage room, so they are found by name wherever
# the binary stands. The file's stem is the name.
set(TUINA_PROGRAMMES
  relax
  before_and_after
  demonstration
  shoulders
  knead_shoulders
  lower_back
  full_back_20min
)
set(TUINA_SHIPPED_PROGRAMMES "")
foreach(programme IN LISTS TUINA_PROGRAMMES)
  set(file ${PROJECT_SOURCE_DIR}/config/programmes/${programme}.toml)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(APPEND TUINA_SHIPPED_PROGRAMMES "      {\"${programme}\", R\"toml(${text})toml\"},\n")
endforeach()
set(TUINA_SHIPPED_PROGRAMMES_CPP ${PROJECT_BINARY_DIR}/generated/shipped_programmes.cpp)
configure_file(${PROJECT_SOURCE_DIR}/tuina/massage/shipped_programmes.cpp.in
  ${TUINA_SHIPPED_PROGRAMMES_CPP} @ONLY)
