# SPDX-License-Identifier: Apache-2.0
# libtuina.so: all rooms in one shared library, of the same objects as the static ones, so it costs a link and no
# compilation. Until 1.0 a minor version may break who links it, hence the two numbers in its soname.
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
get_property(uses GLOBAL PROPERTY tuina_uses)
get_property(hides GLOBAL PROPERTY tuina_hides)
list(REMOVE_DUPLICATES uses)
list(REMOVE_DUPLICATES hides)

add_library(tuina_shared SHARED)
foreach(room IN LISTS TUINA_ROOMS)
  get_target_property(type tuina_${room} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    target_sources(tuina_shared PRIVATE $<TARGET_OBJECTS:tuina_${room}>)
  endif()
endforeach()
set_target_properties(tuina_shared PROPERTIES OUTPUT_NAME tuina EXPORT_NAME shared LINKER_LANGUAGE CXX
  VERSION ${PROJECT_VERSION} SOVERSION ${soversion} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
target_compile_features(tuina_shared INTERFACE cxx_std_20)
target_include_directories(tuina_shared INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include>)
target_link_libraries(tuina_shared PUBLIC ${uses} PRIVATE $<BUILD_INTERFACE:tuina_flags> ${hides})
if(NOT TUINA_SANITIZE)
  target_link_options(tuina_shared PRIVATE -Wl,--no-undefined)
endif()
