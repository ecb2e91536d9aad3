# SPDX-License-Identifier: Apache-2.0
# Script: writes a header that holds the text of FILES (comma separated) as string views in NAMESPACE.
# The text is written as bytes, so any file and any length is safe.
string(REPLACE "," ";" FILES "${FILES}")
set(text "// Generated from the files it names; do not edit.\n#pragma once\n#include <string_view>\n\n")
string(APPEND text "namespace tessera::${NAMESPACE} {\n")
foreach(file ${FILES})
  get_filename_component(stem ${file} NAME)
  string(REGEX REPLACE "[^A-Za-z0-9]" "_" stem ${stem})
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND text "inline constexpr char ${stem}_bytes[] = {${bytes}'\\0'};\n")
  string(APPEND text "inline constexpr std::string_view ${stem}{${stem}_bytes, sizeof(${stem}_bytes) - 1};\n")
endforeach()
string(APPEND text "}  // namespace tessera::${NAMESPACE}\n")
file(WRITE ${OUT} "${text}")
