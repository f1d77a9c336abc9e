// SPDX-License-Identifier: BSD-3-Clause
// Precompiled headers belong to a target, and a target to a source.
#include "precompiled.hpp"
