# SPDX-License-Identifier: Apache-2.0
# What users include: tuina/<room>.hpp, one header for each room, and whatever these include. All other headers are the
# rooms' own, and are neither installed nor part of the reference. Run by itself it prints them:
# `cmake -P cmake/public_headers.cmake`.
cmake_minimum_required(VERSION 3.25)
function(tuina_public_headers source result)
  file(GLOB found RELATIVE ${source} ${source}/tuina/*.hpp)
  set(headers ${found})
  while(found)
    list(POP_FRONT found header)
    file(STRINGS ${source}/${header} lines REGEX "^#include \"tuina/")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" included "${line}")
      if(NOT included IN_LIST headers)
        list(APPEND headers ${included})
        list(APPEND found ${included})
      endif()
    endforeach()
  endwhile()
  list(SORT headers)
  set(${result} ${headers} PARENT_SCOPE)
endfunction()

if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  tuina_public_headers(${CMAKE_CURRENT_LIST_DIR}/.. headers)
  list(JOIN headers "\n" text)
  execute_process(COMMAND ${CMAKE_COMMAND} -E echo "${text}")
endif()
