# SPDX-License-Identifier: Apache-2.0
# Every compiler flag rides on one target, so a consumer of the installed library inherits none of them.
# Structs are filled by designated initialisers that name what differs from the default, which -Wextra would
# call missing initialisers. g++ 12 sees overlaps in std::string's own operator+ that are not there (GCC bug 105651),
# hence -Wno-restrict, and
# members of an empty std::optional that are never read (GCC bug 80635), hence -Wno-maybe-uninitialized.
# Where sources are compiled in batches, types in anonymous namespaces seem to come from headers; that is no error.
add_library(tuina_flags INTERFACE)
# -O3, CMake's own, takes a fifth longer to compile than -O2.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
# One way of code for libraries and programs, so that both can share what is precompiled.
target_compile_options(tuina_flags INTERFACE -fPIC -fno-semantic-interposition)
target_compile_options(tuina_flags INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  -Wno-missing-field-initializers -Wno-restrict -Wno-maybe-uninitialized
  $<$<BOOL:${TUINA_WERROR}>:-Werror> $<$<BOOL:${TUINA_UNITY}>:-Wno-subobject-linkage>)
# g++ collects its garbage again and again while it reads templates; below 1.5 GB it need not, which is a tenth of the
# time for a tenth more memory.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(tuina_flags INTERFACE "SHELL:--param ggc-min-heapsize=1500000")
endif()
# A sanitized build of Eigen without any optimisation is a hundred times slower; -O1 keeps the tests short.
if(TUINA_SANITIZE)
  target_compile_options(tuina_flags INTERFACE -O1 -g1 -fno-omit-frame-pointer
    -fsanitize=${TUINA_SANITIZE} -fno-sanitize-recover=all)
  target_link_options(tuina_flags INTERFACE -fsanitize=${TUINA_SANITIZE})
endif()

# Programs and tests spend their time in the rooms, so what is only theirs is compiled quickly instead.
add_library(tuina_app_flags INTERFACE)
target_link_libraries(tuina_app_flags INTERFACE tuina_flags)
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_options(tuina_app_flags INTERFACE -O1)
endif()
