# SPDX-License-Identifier: BSD-3-Clause
# find_package(jink): jink::planner, which needs Eigen alone, and jink::tracking.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(Eigen3 3.4 NO_MODULE)
include(${CMAKE_CURRENT_LIST_DIR}/jinkTargets.cmake)
