# SPDX-License-Identifier: Apache-2.0
# Two thirds of the time a source takes is reading Eigen, fmt and the standard library, so these are read once per
# set of flags. Sources still include what they use: the `consumer` test and clang build without this.
option(TUINA_PCH "Read the headers that most sources share once" ON)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  set(TUINA_PCH OFF)
endif()
set(TUINA_SHARED_HEADERS <Eigen/Dense> <algorithm> <array> <cmath> <cstdint> <filesystem> <fmt/format.h>
  <functional> <limits> <map> <memory> <numeric> <optional> <span> <string> <string_view> <tl/expected.hpp>
  <utility> <vector>)

# tuina_precompile(<name> FLAGS <target>... HEADERS <header>...) makes a set of headers read once.
function(tuina_precompile name)
  if(NOT TUINA_PCH)
    return()
  endif()
  cmake_parse_arguments(PCH "" "" "FLAGS;HEADERS" ${ARGN})
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${name}.cpp CONTENT "")
  add_library(${name} STATIC ${PROJECT_BINARY_DIR}/generated/${name}.cpp)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE ${PCH_FLAGS} Eigen3::Eigen fmt::fmt tl::expected)
  target_precompile_headers(${name} PRIVATE ${TUINA_SHARED_HEADERS} ${PCH_HEADERS})
endfunction()

# tuina_use_precompiled(<target> <name>): the target's sources begin with that set.
function(tuina_use_precompiled target name)
  if(TUINA_PCH)
    target_precompile_headers(${target} REUSE_FROM ${name})
  endif()
endfunction()

# A first build is shorter when four sources of a room are compiled as one, since what they share is read and
# instantiated once; a build after a change is shorter without.
# Sources of these rooms give things of their own the same names, so each is compiled alone.
set(TUINA_COMPILED_ALONE tissue safety)
option(TUINA_UNITY "Compile the sources of a room in batches" OFF)
function(tuina_in_batches target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${TUINA_UNITY} UNITY_BUILD_BATCH_SIZE 4)
endfunction()

tuina_precompile(tuina_pch FLAGS tuina_flags)
tuina_precompile(tuina_app_pch FLAGS tuina_app_flags nlohmann_json::nlohmann_json
  HEADERS <nlohmann/json.hpp>)
