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
