# SPDX-License-Identifier: BSD-3-Clause
# The Debian packages of what cmake/Install.cmake installs; tools/package.sh makes them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME jink)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${JINK_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(full_version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})

# jink_package(NAME section what): a component's package; sets in the caller's scope.
macro(jink_package name section what)
  string(TOUPPER ${name} upper)
  list(APPEND CPACK_COMPONENTS_ALL ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${what}")
endmacro()

set(CPACK_COMPONENTS_ALL)
jink_package(libjink-dev libdevel "collision-free paths among moving obstacles: the library
The planner of jink: from a vehicle's state and the tracks of moving obstacles
to a path that is verified in continuous time. C++20; needs Eigen alone.
For CMake: find_package(jink), targets jink::planner and jink::tracking.")
set(CPACK_DEBIAN_LIBJINK-DEV_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
if(JINK_BUILD_BRIDGE)
  jink_package(jink science "collision-free flight among moving obstacles
jink plans paths for a drone among moving obstacles and flies them, as a
companion of PX4: state and setpoints over MAVLink, obstacles over DDS.
With a simulator without a screen, and reports of flights. First: jink demo.")
  set(CPACK_DEBIAN_JINK_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_JINK_PACKAGE_SUGGESTS "jink-lab (= ${full_version}), gnuplot-nox, fonts-dejavu-core")
  # A user's changes to them outlive upgrades and a removal.
  file(GLOB_RECURSE conffiles RELATIVE ${PROJECT_SOURCE_DIR}/config CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/config/*.yaml)
  list(TRANSFORM conffiles PREPEND /etc/jink/)
  list(JOIN conffiles "\n" conffiles)
  file(WRITE ${PROJECT_BINARY_DIR}/package/conffiles "${conffiles}\n")
  set(CPACK_DEBIAN_JINK_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/package/conffiles)
  # No package has MAVSDK's library: dpkg-shlibdeps is shown it, and another architecture's libraries.
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/mavsdk)
  if(CMAKE_SYSROOT)
    foreach(folder lib usr/lib)
      list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_SYSROOT}/${folder}/${CMAKE_LIBRARY_ARCHITECTURE})
    endforeach()
  endif()
endif()
if(JINK_BUILD_BRIDGE AND JINK_BUILD_LAB)
  jink_package(jink-lab science "collision-free flight among moving obstacles: what measures it
The arena flies many seeded worlds with jink and its baselines and makes
tables and a page of it; the study runs the experiments of the paper again.
Started by jink arena and jink study.")
  set(CPACK_DEBIAN_JINK-LAB_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_JINK-LAB_PACKAGE_DEPENDS "jink (= ${full_version})")
  set(CPACK_DEBIAN_JINK-LAB_PACKAGE_RECOMMENDS "gnuplot-nox, fonts-dejavu-core")
endif()
include(CPack)
