# SPDX-License-Identifier: Apache-2.0
# Installs the build into a fresh folder, builds the consumer against it and runs it. A library with
# sanitizers in it wants a program that is linked with them.
set(flags)
if(SANITIZE)
  set(flags "-DCMAKE_EXE_LINKER_FLAGS=-fsanitize=${SANITIZE}")
endif()
set(prefix ${BUILD}/consumer)
file(REMOVE_RECURSE ${prefix})
set(steps
  "${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix}/installed"
  "${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/tests/consumer -B ${prefix}/build -DCMAKE_PREFIX_PATH=${prefix}/installed ${flags}"
  "${CMAKE_COMMAND} --build ${prefix}/build"
  "${prefix}/build/consumer"
  "${prefix}/installed/bin/tuina config show --json --quiet")
foreach(step IN LISTS steps)
  separate_arguments(command UNIX_COMMAND "${step}")
  execute_process(COMMAND ${command} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${step}\n${output}")
  endif()
endforeach()
