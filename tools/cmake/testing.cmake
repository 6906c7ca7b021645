# Tests mirror the tree: tests/shared/fixed holds the tests of shared/fixed, built into one program.

find_package(GTest REQUIRED)
include(GoogleTest)

# One ctest run tests the build folders of several presets; the prefix distinguishes their tests.
set(PROLEG_TEST_PREFIX "")
if(PROLEG_SANITIZE)
  set(PROLEG_TEST_PREFIX "asan.")
endif()

# Headers that nearly every test includes, compiled once. Only with clang: gcc gives false warnings that depend on the
# precompiled headers.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  find_package(Eigen3 REQUIRED NO_MODULE)
  add_library(tests_prelude OBJECT ${CMAKE_CURRENT_LIST_DIR}/tests_prelude.cpp)
  target_link_libraries(tests_prelude PRIVATE GTest::gtest Eigen3::Eigen)
  target_precompile_headers(tests_prelude PRIVATE
    <gtest/gtest.h> <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <memory>
    <optional> <random> <span> <sstream> <string> <string_view> <vector>)
  target_compile_options(tests_prelude PRIVATE -Xclang -fno-pch-timestamp)  # otherwise ccache finds no match
endif()

# proleg_test(<path> SOURCES ... [DEPENDS rooms...] [LIBRARIES targets...] [LABELS ...] [TIMEOUT seconds])
#   path   the tested room or subject, e.g. shared/fixed; each GoogleTest case becomes a ctest test
function(proleg_test path)
  cmake_parse_arguments(PARSE_ARGV 1 test "" "TIMEOUT" "SOURCES;DEPENDS;LIBRARIES;LABELS")
  string(REPLACE "/" "_" name ${path})
  add_executable(${name}_test ${test_SOURCES})
  foreach(dependency IN LISTS test_DEPENDS)
    string(REPLACE "/" "_" dependency_target ${dependency})
    target_link_libraries(${name}_test PRIVATE proleg::${dependency_target})
  endforeach()
  target_link_libraries(${name}_test PRIVATE ${test_LIBRARIES} proleg::tests_support GTest::gtest GTest::gtest_main)
  if(TARGET tests_prelude)
    target_precompile_headers(${name}_test REUSE_FROM tests_prelude)
  endif()
  if(NOT test_TIMEOUT)
    set(test_TIMEOUT 300)
  endif()
  set(properties TIMEOUT ${test_TIMEOUT})
  if(PROLEG_SANITIZE)
    list(APPEND properties ENVIRONMENT
         "LSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/tests/leak_suppressions.txt:print_suppressions=0")
  endif()
  if(test_LABELS)
    list(APPEND properties LABELS "${test_LABELS}")
  endif()
  gtest_discover_tests(${name}_test
    TEST_PREFIX "${PROLEG_TEST_PREFIX}${path}."
    NO_PRETTY_VALUES
    DISCOVERY_TIMEOUT 60
    PROPERTIES ${properties})
endfunction()
