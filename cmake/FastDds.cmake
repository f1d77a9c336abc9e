# SPDX-License-Identifier: BSD-3-Clause
# Target jink_idl: the DDS types of bridge/dds/idl, generated at build time by fastddsgen, with Fast DDS and Fast CDR.
# Not our code: its headers are SYSTEM and it is compiled without the project's warnings. Only the data types are
# compiled in: topics travel as payloads (bridge/dds/payload_io), so fastddsgen's own type support is not needed.
find_package(fastcdr REQUIRED)
find_package(fastrtps 2.9 REQUIRED)
find_program(FASTDDSGEN fastddsgen)
if(NOT FASTDDSGEN)
  message(FATAL_ERROR "fastddsgen not found (Debian package fastddsgen); run tools/setup.sh first, or configure with "
                      "-DJINK_BUILD_BRIDGE=OFF")
endif()

# One run for all files: each that includes another writes that one's outputs again.
set(_idl_names RosCommon ObstacleTracks Intents TrackedObjects Detections Px4)
set(_idl_dir ${PROJECT_BINARY_DIR}/idl)
file(MAKE_DIRECTORY ${_idl_dir})  # fastddsgen does not make it
list(TRANSFORM _idl_names PREPEND ${PROJECT_SOURCE_DIR}/bridge/dds/idl/ OUTPUT_VARIABLE _idl_files)
list(TRANSFORM _idl_files APPEND .idl)
set(_idl_outputs)
foreach(_name ${_idl_names})
  list(APPEND _idl_outputs ${_idl_dir}/${_name}.h ${_idl_dir}/${_name}.cxx)
endforeach()
add_custom_command(
  OUTPUT ${_idl_outputs}
  COMMAND ${FASTDDSGEN} -replace -I ${PROJECT_SOURCE_DIR}/bridge/dds/idl -d ${_idl_dir} ${_idl_files}
  DEPENDS ${_idl_files}
  COMMENT "Generating DDS types from bridge/dds/idl"
  VERBATIM)

add_library(jink_idl STATIC ${_idl_outputs})
target_include_directories(jink_idl SYSTEM PUBLIC ${_idl_dir})
target_link_libraries(jink_idl PUBLIC fastrtps fastcdr)
target_compile_options(jink_idl PRIVATE -w)
if(JINK_SANITIZE)  # the sanitizers watch this code too; the warnings of jink_options do not
  target_compile_options(jink_idl PRIVATE -fsanitize=${JINK_SANITIZE} -fno-omit-frame-pointer)
endif()
