// SPDX-License-Identifier: BSD-3-Clause
// The page without its data. The source is generated from template.html and the files that it includes: see
// cmake/embed.cmake.
#pragma once

#include <string_view>

namespace jink::tools::report {

/// HTML with one "{{data}}", where the flight's data go as JSON. Valid for the program's life.
std::string_view report_template();

}  // namespace jink::tools::report
