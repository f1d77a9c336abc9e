# SPDX-License-Identifier: BSD-3-Clause
# A room is a folder: a CMake target, a namespace and an include path of the same name. A room sees the headers of the
# rooms that it links and no others: each has an include folder of its own, which holds a link to the room under its
# full path. tests/check_rooms.py holds the tree to that.

# jink_precompile(NAME targets...): a target whose precompiled headers (precompiled.hpp) others with the same options use.
function(jink_precompile name)
  add_library(${name} OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
  target_link_libraries(${name} PRIVATE ${ARGN} Eigen3::Eigen jink_options)
  target_precompile_headers(${name} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/precompiled.hpp)
endfunction()

# jink_room_headers(): sets, of the room it is called in, `folder`, `name` (bridge_tracking) and its include folder `include`.
macro(jink_room_headers)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REPLACE "/" "_" name ${folder})
  set(include ${PROJECT_BINARY_DIR}/rooms/${name})
  get_filename_component(parent ${include}/${folder} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${include}/${folder} SYMBOLIC)
endmacro()

# jink_room([LINK targets...] [PRIVATE targets...] [SOURCES generated files...] [OWN_OPTIONS])
# Makes the library of the room it is called in, of all *.cpp there: bridge/tracking gives jink::bridge::tracking.
# LINK: what its headers use as well. PRIVATE: what its sources alone use. OWN_OPTIONS: it has compile options that the
# precompiled headers were not made with.
function(jink_room)
  cmake_parse_arguments(R "OWN_OPTIONS" "" "LINK;PRIVATE;SOURCES" ${ARGN})
  jink_room_headers()
  string(REPLACE "/" "::" alias ${folder})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  if(sources)
    add_library(jink_${name} STATIC ${sources} ${R_SOURCES})
    target_include_directories(jink_${name} PUBLIC $<BUILD_INTERFACE:${include}>)
    target_link_libraries(jink_${name} PUBLIC ${R_LINK} PRIVATE ${R_PRIVATE} $<BUILD_INTERFACE:jink_options>)
    if(TARGET jink_headers AND NOT R_OWN_OPTIONS)
      target_precompile_headers(jink_${name} REUSE_FROM jink_headers)
    endif()
  else()
    add_library(jink_${name} INTERFACE)
    target_include_directories(jink_${name} INTERFACE $<BUILD_INTERFACE:${include}>)
    target_link_libraries(jink_${name} INTERFACE ${R_LINK})
  endif()
  add_library(jink::${alias} ALIAS jink_${name})
endfunction()
