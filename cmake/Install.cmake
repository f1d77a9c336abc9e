# SPDX-License-Identifier: BSD-3-Clause
# What `cmake --install` and the packages (tools/package.sh) carry, by component: jink, jink-lab, libjink-dev, which are
# the packages' names. Nothing that is installed names the source tree or the build folder.

# Nobody who packs three programs wants all tests compiled: what is installed is built before, by name.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)

# Who packs, as for Debian's own tools.
set(JINK_MAINTAINER "the jink authors <jink@example.org>")
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(JINK_MAINTAINER "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()

# jink_install_program(target): with the way to the MAVSDK that the component jink has.
function(jink_install_program target component)
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib/jink/mavsdk")
  install(TARGETS ${target} RUNTIME DESTINATION bin COMPONENT ${component})
  get_target_property(name ${target} OUTPUT_NAME)
  if(NOT name)
    set(name ${target})
  endif()
  install(FILES ${PROJECT_SOURCE_DIR}/tools/package/completion.bash DESTINATION share/bash-completion/completions
          RENAME ${name} COMPONENT ${component})
  jink_install_gzipped(${PROJECT_SOURCE_DIR}/tools/package/${name}.1 ${name}.1 share/man/man1 ${component})
endfunction()

# jink_install_gzipped(file name folder component): as folder/name.gz, the same bytes whenever it is made.
function(jink_install_gzipped file name folder component)
  set(copy ${PROJECT_BINARY_DIR}/package/${component}/${name})
  configure_file(${file} ${copy} @ONLY)
  execute_process(COMMAND gzip -9nkf ${copy} COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${copy}.gz DESTINATION ${folder} COMPONENT ${component})
endfunction()

# What every package has to have.
function(jink_install_documents component)
  set(folder share/doc/${component})
  file(READ ${PROJECT_SOURCE_DIR}/tools/package/copyright copyright)
  if(component STREQUAL jink)
    file(READ ${PROJECT_SOURCE_DIR}/tools/package/copyright-mavsdk more)
    string(APPEND copyright "\n${more}")
  endif()
  file(WRITE ${PROJECT_BINARY_DIR}/package/${component}/copyright "${copyright}")
  install(FILES ${PROJECT_BINARY_DIR}/package/${component}/copyright DESTINATION ${folder} COMPONENT ${component})
  jink_install_gzipped(${PROJECT_SOURCE_DIR}/tools/package/changelog changelog.Debian ${folder} ${component})
  jink_install_gzipped(${PROJECT_SOURCE_DIR}/CHANGELOG.md changelog ${folder} ${component})
endfunction()

# jink_install_library(name rooms...): jink::NAME, with the rooms that it consists of.
function(jink_install_library name)
  set(targets jink_${name})
  foreach(room ${ARGN})
    string(REPLACE "/" "_" target jink_${room})
    string(REPLACE "/" "::" alias ${room})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${alias})
    target_include_directories(${target} INTERFACE $<INSTALL_INTERFACE:include/jink>)
    set_property(TARGET ${target} APPEND PROPERTY INTERFACE_COMPILE_FEATURES cxx_std_20)
    # Functions in headers are compiled by whoever includes them, and one copy of each is linked.
    target_compile_options(${target} INTERFACE "$<INSTALL_INTERFACE:${JINK_SAME_BITS}>")
    list(APPEND targets ${target})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room}/ DESTINATION include/jink/${room} COMPONENT libjink-dev
            FILES_MATCHING PATTERN *.hpp)
  endforeach()
  set_target_properties(jink_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${targets} EXPORT jinkTargets ARCHIVE DESTINATION lib COMPONENT libjink-dev)
endfunction()

function(jink_install_libraries)
  jink_install_library(planner planner/base planner/geometry planner/optimizer planner/verify planner/paper planner/horizon)
  if(JINK_BUILD_BRIDGE)
    jink_install_library(tracking bridge/base bridge/prediction bridge/tracking)
  endif()
  set(folder lib/cmake/jink)
  install(EXPORT jinkTargets NAMESPACE jink:: DESTINATION ${folder} COMPONENT libjink-dev)
  include(CMakePackageConfigHelpers)
  # While the major version is 0, each minor one has other interfaces.
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/jinkConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/jinkConfig.cmake ${PROJECT_BINARY_DIR}/package/jinkConfigVersion.cmake
          DESTINATION ${folder} COMPONENT libjink-dev)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION share/doc/libjink-dev COMPONENT libjink-dev)
  jink_install_documents(libjink-dev)
endfunction()

# The files of config/: beside what is installed to /usr in /etc, elsewhere in the prefix's own etc (config_folder() in
# config/settings.hpp looks there).
function(jink_install_config)
  set(files planner.yaml missions scenarios vehicles)
  list(TRANSFORM files PREPEND ${PROJECT_SOURCE_DIR}/config/)
  install(CODE "set(jink_config_files \"${files}\")
  set(jink_etc \"\${CMAKE_INSTALL_PREFIX}/etc/jink\")
  if(CMAKE_INSTALL_PREFIX MATCHES \"/usr/*\\$\")
    set(jink_etc \"\${CMAKE_INSTALL_PREFIX}/../etc/jink\")
  endif()
  get_filename_component(jink_etc \"\${jink_etc}\" ABSOLUTE)
  file(INSTALL \${jink_config_files} DESTINATION \"\${jink_etc}\")" COMPONENT jink)
endfunction()

# MAVSDK's library for jink and jink-lab alone: so deep in lib that CPack does not think it is for all, and calls no
# ldconfig.
function(jink_install_mavsdk)
  get_target_property(library mavsdk_c IMPORTED_LOCATION)
  install(FILES ${library} DESTINATION lib/jink/mavsdk COMPONENT jink)
  get_filename_component(name ${library} NAME)
  install(CODE "if(CMAKE_INSTALL_DO_STRIP)
    execute_process(COMMAND \"${CMAKE_STRIP}\" --strip-unneeded
                    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/lib/jink/mavsdk/${name}\" COMMAND_ERROR_IS_FATAL ANY)
  endif()" COMPONENT jink)
endfunction()

# All of it, and how it is packed.
function(jink_install)
  jink_install_libraries()
  if(JINK_BUILD_BRIDGE)
    jink_install_program(jink jink)
    jink_install_config()
    jink_install_mavsdk()
    install(FILES ${PROJECT_SOURCE_DIR}/tools/package/jink.service DESTINATION lib/systemd/system COMPONENT jink)
    jink_install_documents(jink)
    install(FILES ${PROJECT_SOURCE_DIR}/tools/package/lintian-overrides DESTINATION share/lintian/overrides RENAME jink
            COMPONENT jink)
    if(JINK_BUILD_LAB)
      jink_install_program(jink_lab jink-lab)
      jink_install_documents(jink-lab)
    endif()
  endif()
  include(${PROJECT_SOURCE_DIR}/cmake/Package.cmake)
endfunction()
