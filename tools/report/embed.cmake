# SPDX-License-Identifier: BSD-3-Clause
# cmake -DPAGE=template.html -DPARTS=style.css,page.js -DOUTPUT=template.cpp -P embed.cmake
# Puts the parts in the places {{NAME}} of the page and the page in a C++ source, byte by byte: no limit on length, no
# quoting to get wrong.
file(READ ${PAGE} page)
string(REPLACE "," ";" parts "${PARTS}")
get_filename_component(folder ${PAGE} DIRECTORY)
foreach(part IN LISTS parts)
  file(READ ${folder}/${part} text)
  string(FIND "${page}" "{{${part}}}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "${PAGE} has no place {{${part}}}")
  endif()
  string(REPLACE "{{${part}}}" "${text}" page "${page}")
endforeach()
string(HEX "${page}" bytes)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REPEAT "0x..," 20 row)
string(REGEX REPLACE "(${row})" "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT} "// Generated from ${PAGE} by embed.cmake: do not edit.
#include \"tools/report/template.hpp\"

namespace jink::tools {
namespace {
constexpr unsigned char kBytes[] = {
${bytes}};
}  // namespace

std::string_view report_template() { return {reinterpret_cast<const char*>(kBytes), sizeof(kBytes)}; }

}  // namespace jink::tools
")
