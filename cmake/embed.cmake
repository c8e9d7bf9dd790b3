# SPDX-License-Identifier: Apache-2.0
# tuina_embed(<template.cpp.in> <result> FILES <file>...) builds files into a room, so they are found wherever the
# binary stands: the template's @TUINA_EMBEDDED@ becomes the list of their stems and texts.
function(tuina_embed template result)
  cmake_parse_arguments(EMBED "" "" "FILES" ${ARGN})
  set(TUINA_EMBEDDED "")
  foreach(file IN LISTS EMBED_FILES)
    set(path ${PROJECT_SOURCE_DIR}/${file})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
    file(READ ${path} text)
    get_filename_component(stem ${file} NAME_WE)
    string(APPEND TUINA_EMBEDDED "      {\"${stem}\", R\"text(${text})text\"},\n")
  endforeach()
  configure_file(${template} ${PROJECT_BINARY_DIR}/generated/${result} @ONLY)
endfunction()

# tuina_embed_binary(<target> <name> <folder> FILES <file>... DEFINES <macro>) puts files as they are into a library,
# where all of them are there; the target then knows the macro, and each file by the names that `ld -b binary` gives.
function(tuina_embed_binary target name folder)
  cmake_parse_arguments(EMBED "" "DEFINES" "FILES" ${ARGN})
  list(TRANSFORM EMBED_FILES PREPEND ${folder}/ OUTPUT_VARIABLE paths)
  foreach(path IN LISTS paths)
    if(NOT EXISTS ${path})
      return()
    endif()
  endforeach()
  set(object ${CMAKE_CURRENT_BINARY_DIR}/${name}.o)
  add_custom_command(OUTPUT ${object} COMMAND ${CMAKE_LINKER} -r -z noexecstack -b binary ${EMBED_FILES} -o ${object}
    DEPENDS ${paths} WORKING_DIRECTORY ${folder} VERBATIM)
  target_sources(${target} PRIVATE ${object})
  set_source_files_properties(${object} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  target_compile_definitions(${target} PRIVATE ${EMBED_DEFINES})
endfunction()
