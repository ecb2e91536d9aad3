# SPDX-License-Identifier: Apache-2.0
# How every target of tessera is compiled, tested and given embedded files.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

add_library(tessera_options INTERFACE)
target_compile_features(tessera_options INTERFACE cxx_std_20)
target_include_directories(tessera_options INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
# GCC 12 sees an overlap in every assignment of a literal to a string (its bug 105651): -Wno-restrict.
# It remarks that vectors wider than the processor's are passed otherwise than on others, where all of a program is
# built for one: -Wno-psabi.
# No fast-math: the same bits on every worker of a device class. errno and trapping are never looked at.
target_compile_options(tessera_options INTERFACE
  -march=${TESSERA_ARCH} -fno-math-errno -fno-trapping-math
  -Wall -Wextra -Wpedantic -Wshadow -Wno-missing-field-initializers -Wno-restrict -Wno-psabi
  $<$<BOOL:${TESSERA_WERROR}>:-Werror>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(tessera_options INTERFACE -Wno-unknown-warning-option)  # those of GCC
endif()
if(TESSERA_FUZZ)
  target_compile_options(tessera_options INTERFACE -fsanitize=fuzzer-no-link -fno-sanitize-recover=all)
endif()
if(TESSERA_SANITIZE)
  target_compile_options(tessera_options INTERFACE -fsanitize=${TESSERA_SANITIZE} -fno-omit-frame-pointer -O1
    -Wno-maybe-uninitialized)  # false alarms of GCC 12 where checks are woven in
  target_link_options(tessera_options INTERFACE -fsanitize=${TESSERA_SANITIZE})
endif()

# tessera_library(NAME SOURCES ... LINK ... [PRIVATE ...])
function(tessera_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC tessera_options ${ARG_LINK} PRIVATE ${ARG_PRIVATE})
endfunction()

# tessera_test(NAME SOURCES ... LINK ...): one GoogleTest binary, one ctest entry per test case. What is tested has been
# optimised; the tests themselves take longer to compile than to run.
function(tessera_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE tessera_options ${ARG_LINK} GTest::gmock GTest::gtest_main)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${name} PRIVATE TESSERA_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 900
    ENVIRONMENT "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp"
    ENVIRONMENT_MODIFICATION "TESSERA_TEXTURE_CACHE=set:${PROJECT_BINARY_DIR}/textures")
endfunction()

# tessera_together(TARGET [APART FILES ...]): its files are compiled six at a time, as the headers and templates
# that they share take longer than what is in them. APART: those whose private names clash with those of others.
function(tessera_together target)
  cmake_parse_arguments(ARG "" "" "APART" ${ARGN})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
  set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# tessera_embed(TARGET NAMESPACE FILES ...): each FILE becomes `std::string_view <namespace>::<stem>` in
# generated/<namespace>.h, where <stem> is the file name with everything but letters and digits turned to '_'.
function(tessera_embed target namespace)
  set(header ${PROJECT_BINARY_DIR}/generated/${namespace}.h)
  set(files)
  foreach(file ${ARGN})
    list(APPEND files ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  endforeach()
  string(REPLACE ";" "," joined "${files}")
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DOUT=${header} -DNAMESPACE=${namespace} -DFILES=${joined}
            -P ${PROJECT_SOURCE_DIR}/cmake/Embed.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/Embed.cmake VERBATIM)
  target_sources(${target} PRIVATE ${header})
endfunction()
