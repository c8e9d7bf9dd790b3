# SPDX-License-Identifier: Apache-2.0
# Installs the build into a fresh folder, builds the consumer against it, static and shared, and runs it. A library with
# sanitizers in it wants a program that is linked with them.
set(flags)
if(SANITIZE)
  set(flags "-DCMAKE_EXE_LINKER_FLAGS=-fsanitize=${SANITIZE}")
endif()
set(prefix ${BUILD}/consumer)
file(REMOVE_RECURSE ${prefix})
set(steps
  "${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix}/installed"
  "${prefix}/installed/bin/tuina config show --json --quiet")
foreach(said IN ITEMS share/man/man1/tuina.1.gz share/bash-completion/completions/tuina
    share/zsh/vendor-completions/_tuina share/fish/vendor_completions.d/tuina.fish)
  list(APPEND steps "${CMAKE_COMMAND} -E md5sum ${prefix}/installed/${said}")
endforeach()
foreach(kind IN ITEMS static shared)
  list(APPEND steps
    "${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/tests/consumer -B ${prefix}/${kind} -DCMAKE_PREFIX_PATH=${prefix}/installed -DKIND=${kind} ${flags}"
    "${CMAKE_COMMAND} --build ${prefix}/${kind}"
    "${prefix}/${kind}/consumer")
endforeach()
foreach(step IN LISTS steps)
  separate_arguments(command UNIX_COMMAND "${step}")
  execute_process(COMMAND ${command} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${step}\n${output}")
  endif()
endforeach()
