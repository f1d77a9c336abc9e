// SPDX-License-Identifier: BSD-3-Clause
// The version of jink, for all of its parts: CMakeLists.txt reads it from here.
#pragma once

/// Major version: interfaces of another one differ.
#define JINK_VERSION_MAJOR 0
/// Minor version: more in the same interfaces; while the major version is 0, other interfaces.
#define JINK_VERSION_MINOR 1
/// Patch: mended.
#define JINK_VERSION_PATCH 0
/// All three as text.
#define JINK_VERSION "0.1.0"
