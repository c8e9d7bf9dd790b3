# SPDX-License-Identifier: Apache-2.0
# The table of rooms: which room may include which. It is written here and nowhere else; tuina_room links
# by it and the `layering` test reads the #include lines of the sources against it.
set(TUINA_ROOMS core telemetry scanner calibration body massage tissue robot hardware safety link control motion
  session record history ros2 web sim baselines)
set(TUINA_MAY_INCLUDE_core "")
set(TUINA_MAY_INCLUDE_telemetry core)
set(TUINA_MAY_INCLUDE_scanner core)
set(TUINA_MAY_INCLUDE_calibration core scanner)
set(TUINA_MAY_INCLUDE_body core)
set(TUINA_MAY_INCLUDE_massage core body)
set(TUINA_MAY_INCLUDE_tissue core)
set(TUINA_MAY_INCLUDE_robot core)
set(TUINA_MAY_INCLUDE_hardware core scanner robot)
set(TUINA_MAY_INCLUDE_safety core robot)
set(TUINA_MAY_INCLUDE_link core robot safety)
set(TUINA_MAY_INCLUDE_control core robot)
set(TUINA_MAY_INCLUDE_motion core body massage robot control)
set(TUINA_MAY_INCLUDE_session core scanner body massage tissue robot safety link control motion)
set(TUINA_MAY_INCLUDE_record core telemetry body massage tissue robot safety motion session)
set(TUINA_MAY_INCLUDE_history core telemetry tissue session record)
set(TUINA_MAY_INCLUDE_ros2 core telemetry session record)
# A page is another hand at the live commands of a session, and knows no more of it.
set(TUINA_MAY_INCLUDE_web core session)
set(TUINA_MAY_INCLUDE_sim core scanner robot tissue)
# What the thesis and peers do, to judge tuina by: no room of the product may include it.
set(TUINA_MAY_INCLUDE_baselines core body tissue control)

# The programs, in the same way: folders of apps/. Product rooms are all but sim and baselines.
set(TUINA_PRODUCT core telemetry scanner calibration body massage tissue robot hardware safety link control motion
  session record history ros2 web)
set(TUINA_APPS cli simulated evaluation serve tuina)
set(TUINA_APP_MAY_INCLUDE_cli ${TUINA_PRODUCT})
set(TUINA_APP_MAY_INCLUDE_simulated ${TUINA_PRODUCT} sim apps/cli)
set(TUINA_APP_MAY_INCLUDE_evaluation ${TUINA_PRODUCT} sim baselines apps/cli apps/simulated)
set(TUINA_APP_MAY_INCLUDE_serve ${TUINA_PRODUCT} apps/cli apps/simulated)
set(TUINA_APP_MAY_INCLUDE_tuina ${TUINA_PRODUCT} sim baselines apps/cli apps/simulated apps/serve)

# The modules of Python, folders of python/: that of the product, and the one that knows the simulated world.
set(TUINA_PYTHON module simulation)
set(TUINA_PYTHON_MAY_INCLUDE_module ${TUINA_PRODUCT} apps/cli)
set(TUINA_PYTHON_MAY_INCLUDE_simulation ${TUINA_PRODUCT} sim apps/cli apps/simulated python/module)

# tuina_room(<name> SOURCES <file>... [HOT <file>...] [USES <public target>...] [HIDES <private target>...])
# makes the library tuina::<name> of one room. HOT are sources that are worth -O3, each compiled alone: the
# benchmarks show what it gains. USES are third-party targets that its headers show, HIDES those that only its .cpp
# files know.
function(tuina_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;HOT;USES;HIDES" ${ARGN})
  set(target tuina_${name})
  if(ROOM_SOURCES)
    add_library(${target} STATIC ${ROOM_SOURCES} ${ROOM_HOT})
    if(ROOM_HOT)
      set_source_files_properties(${ROOM_HOT} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O3>
        SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
    endif()
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:tuina_flags> ${ROOM_HIDES})
    tuina_use_precompiled(${target} tuina_pch)
    if(NOT name IN_LIST TUINA_COMPILED_ALONE)
      tuina_in_batches(${target})
    endif()
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(tuina::${name} ALIAS ${target})
  set_property(GLOBAL APPEND PROPERTY tuina_uses ${ROOM_USES})
  set_property(GLOBAL APPEND PROPERTY tuina_hides ${ROOM_HIDES})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${target} ${scope} cxx_std_20)
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include>)
  foreach(room IN LISTS TUINA_MAY_INCLUDE_${name})
    target_link_libraries(${target} ${scope} tuina_${room})
  endforeach()
  target_link_libraries(${target} ${scope} ${ROOM_USES})
endfunction()

# tuina_app_library(<name> SOURCES <file>... LINKS <target>...) makes one folder of apps/ but the program itself.
function(tuina_app_library name)
  cmake_parse_arguments(APP "" "" "SOURCES;LINKS" ${ARGN})
  set(target tuina_app_${name})
  add_library(${target} STATIC ${APP_SOURCES})
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${target} PUBLIC ${APP_LINKS} PRIVATE tuina_app_flags)
  tuina_use_precompiled(${target} tuina_app_pch)
endfunction()
