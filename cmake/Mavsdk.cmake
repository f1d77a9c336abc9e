# SPDX-License-Identifier: BSD-3-Clause
# Target mavsdk_c: MAVSDK's C interface, out of the Python wheel in .venv, or of another architecture's wheel in the
# sysroot. There is no C or C++ development package of it on Debian; the wheel's one library needs the C library alone, and
# bridge/mavsdk/c_api.h declares what is used of it.
# Its SONAME has a version that the file's name lacks, so it is copied to that name beside the binaries.
set(_mavsdk_place ${PROJECT_SOURCE_DIR}/.venv/lib/python3*/site-packages/mavsdk/lib)
if(CMAKE_SYSROOT)
  set(_mavsdk_place ${CMAKE_SYSROOT}/usr/lib)
endif()
file(GLOB _mavsdk_wheel ${_mavsdk_place}/libcmavsdk.so)
if(NOT _mavsdk_wheel)
  message(FATAL_ERROR "MAVSDK not found: no ${_mavsdk_place}/libcmavsdk.so; run tools/setup.sh first, or configure with "
                      "-DJINK_BUILD_BRIDGE=OFF")
endif()
list(GET _mavsdk_wheel 0 _mavsdk_wheel)
set(_mavsdk_dir ${PROJECT_BINARY_DIR}/mavsdk)
file(MAKE_DIRECTORY ${_mavsdk_dir})
# Copied again only when the wheel's file changed, so that a new configuration does not relink everything.
configure_file(${_mavsdk_wheel} ${_mavsdk_dir}/libcmavsdk.so.3 COPYONLY)
file(CREATE_LINK libcmavsdk.so.3 ${_mavsdk_dir}/libcmavsdk.so SYMBOLIC)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${_mavsdk_wheel})

# An imported target gives each binary that links it the folder in its build RPATH.
add_library(mavsdk_c SHARED IMPORTED GLOBAL)
set_target_properties(mavsdk_c PROPERTIES IMPORTED_LOCATION ${_mavsdk_dir}/libcmavsdk.so.3
                                          IMPORTED_SONAME libcmavsdk.so.3)
