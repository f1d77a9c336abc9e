# SPDX-License-Identifier: BSD-3-Clause
# cmake -DFILE=template.html -DPARTS=style.css,page.js -DHEADER=tools/report/template.hpp -DNAMESPACE=jink::tools
#       -DFUNCTION=report_template -DOUTPUT=template.cpp -P embed.cmake
# Puts the parts (none: leave PARTS out) in the places {{NAME}} of the file and the file in a C++ source that defines
# `std::string_view FUNCTION()`, which HEADER declares; byte by byte: no limit on length, no quoting to get wrong.
file(READ ${FILE} text)
string(REPLACE "," ";" parts "${PARTS}")
get_filename_component(folder ${FILE} DIRECTORY)
foreach(part IN LISTS parts)
  file(READ ${folder}/${part} inner)
  string(FIND "${text}" "{{${part}}}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "${FILE} has no place {{${part}}}")
  endif()
  string(REPLACE "{{${part}}}" "${inner}" text "${text}")
endforeach()
string(HEX "${text}" bytes)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REPEAT "0x..," 20 row)
string(REGEX REPLACE "(${row})" "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT} "// Generated from ${FILE} by embed.cmake: do not edit.
#include \"${HEADER}\"

namespace ${NAMESPACE} {

std::string_view ${FUNCTION}() {
  static constexpr unsigned char bytes[] = {
${bytes}};
  return {reinterpret_cast<const char*>(bytes), sizeof(bytes)};
}

}  // namespace ${NAMESPACE}
")
