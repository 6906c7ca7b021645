# Headers that nearly every source includes, compiled once: most of the compile time goes into Eigen and the standard
# library. A source that lacks an include may compile with them, so tools/check --slow builds the preset host without.
option(PROLEG_PRELUDES "Precompile the headers that most sources include" ON)

# proleg_prelude(<name> HEADERS <header>... LIBRARIES target... [OPTIONS compiler options...])
#   A target whose precompiled headers others use again: target_precompile_headers(<target> REUSE_FROM <name>). Its options
#   are those with which the headers are compiled; those of the other targets must be the same.
function(proleg_prelude name)
  cmake_parse_arguments(PARSE_ARGV 1 prelude "" "" "HEADERS;LIBRARIES;OPTIONS")
  add_library(${name} OBJECT ${CMAKE_SOURCE_DIR}/tools/cmake/prelude.cpp)
  target_link_libraries(${name} PRIVATE ${prelude_LIBRARIES})
  target_compile_options(${name} PRIVATE ${prelude_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${prelude_HEADERS})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${name} PRIVATE -Xclang -fno-pch-timestamp)  # otherwise ccache finds no match
  endif()
endfunction()

if(PROLEG_PRELUDES AND NOT CMAKE_CROSSCOMPILING)
  find_package(Eigen3 REQUIRED NO_MODULE)
  proleg_prelude(programs_prelude
    LIBRARIES Eigen3::Eigen
    HEADERS <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <memory>
            <optional> <span> <sstream> <string> <string_view> <vector>)
endif()
