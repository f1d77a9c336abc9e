# SPDX-License-Identifier: BSD-3-Clause
# Target jink_idl: the DDS types of bridge/idl, generated at build time by fastddsgen, with Fast DDS and Fast CDR.
# Not our code: its headers are SYSTEM and it is compiled without the project's warnings.
find_package(fastcdr REQUIRED)
find_package(fastrtps 2.9 REQUIRED)
find_program(FASTDDSGEN fastddsgen)
if(NOT FASTDDSGEN)
  message(FATAL_ERROR "fastddsgen not found (Debian package fastddsgen); run tools/setup.sh first, or configure with "
                      "-DJINK_BUILD_BRIDGE=OFF")
endif()

set(_idl_dir ${PROJECT_BINARY_DIR}/idl)
set(_idl_file ${PROJECT_SOURCE_DIR}/bridge/idl/ObstacleTracks.idl)
set(_idl_outputs)
foreach(_suffix .h .cxx PubSubTypes.h PubSubTypes.cxx)
  list(APPEND _idl_outputs ${_idl_dir}/ObstacleTracks${_suffix})
endforeach()
file(MAKE_DIRECTORY ${_idl_dir})  # fastddsgen does not make it
add_custom_command(
  OUTPUT ${_idl_outputs}
  COMMAND ${FASTDDSGEN} -replace -d ${_idl_dir} ${_idl_file}
  DEPENDS ${_idl_file}
  COMMENT "Generating DDS types from bridge/idl/ObstacleTracks.idl"
  VERBATIM)

add_library(jink_idl STATIC ${_idl_outputs})
target_include_directories(jink_idl SYSTEM PUBLIC ${_idl_dir})
target_link_libraries(jink_idl PUBLIC fastrtps fastcdr)
target_compile_options(jink_idl PRIVATE -w)
if(JINK_SANITIZE)  # the sanitizers watch this code too; the warnings of jink_options do not
  target_compile_options(jink_idl PRIVATE -fsanitize=${JINK_SANITIZE} -fno-omit-frame-pointer)
endif()
