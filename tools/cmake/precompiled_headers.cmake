# Headers that nearly every source includes, compiled once: most of the compile time goes into Eigen and the standard
# library. A source that lacks an include may compile with them, so tools/check --slow builds the preset host without.
option(PROLEG_PRECOMPILED_HEADERS "Precompile the headers that most sources include" ON)

# proleg_precompiled_headers(<name> HEADERS <header>... LIBRARIES target... [OPTIONS compiler options...])
#   A target whose precompiled headers others use again: target_precompile_headers(<target> REUSE_FROM <name>). Its options
#   are those with which the headers are compiled; those of the other targets must be the same.
function(proleg_precompiled_headers name)
  cmake_parse_arguments(PARSE_ARGV 1 precompiled "" "" "HEADERS;LIBRARIES;OPTIONS")
  add_library(${name} OBJECT ${CMAKE_SOURCE_DIR}/tools/cmake/precompiled_headers.cpp)
  target_link_libraries(${name} PRIVATE ${precompiled_LIBRARIES})
  target_compile_options(${name} PRIVATE ${precompiled_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${precompiled_HEADERS})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${name} PRIVATE -Xclang -fno-pch-timestamp)  # otherwise ccache finds no match
  endif()
endfunction()

# Rooms that compute little, or mostly wait: fewer optimisations shorten their compile time under the sanitizers, and make the
# programs of users smaller.
if(PROLEG_SANITIZE)
  set(PROLEG_LIGHT_ROOMS "^(tools|host/(remote|robot|robot_control|server|transport)|sim/(data_file|record|scenario|optimize/(confirm|evaluation|experiment|mpi|report|sweep)))(/|$)")
  set(PROLEG_LIGHT_OPTION -O0)
else()
  set(PROLEG_LIGHT_ROOMS "^(tools|host|sim/(authoring|mjcf|scenario|urdf|optimize/(confirm|experiment|report|sweep)))(/|$)")
  set(PROLEG_LIGHT_OPTION -Os)
endif()

# The rooms of the bus, of the page and of the commands, and what most of their sources include.
set(PROLEG_NETWORK_ROOMS "^(host/(remote|robot|server|transport)|tools/proleg)(/|$)")
set(PROLEG_NETWORK_HEADERS <boost/asio/io_context.hpp> <boost/asio/ip/tcp.hpp> <boost/asio/posix/stream_descriptor.hpp>
    <boost/asio/steady_timer.hpp> <nlohmann/json.hpp>)

if(PROLEG_PRECOMPILED_HEADERS AND NOT PROLEG_TARGET)
  find_package(Eigen3 REQUIRED NO_MODULE)
  set(program_headers <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <memory>
      <optional> <span> <sstream> <string> <string_view> <vector>)
  proleg_precompiled_headers(program_headers LIBRARIES Eigen3::Eigen HEADERS ${program_headers})
  proleg_precompiled_headers(light_program_headers LIBRARIES Eigen3::Eigen HEADERS ${program_headers} OPTIONS ${PROLEG_LIGHT_OPTION})
  find_package(Boost REQUIRED)
  find_package(nlohmann_json REQUIRED)
  proleg_precompiled_headers(network_program_headers LIBRARIES Eigen3::Eigen Boost::headers nlohmann_json::nlohmann_json
      HEADERS ${program_headers} ${PROLEG_NETWORK_HEADERS}
      OPTIONS ${PROLEG_LIGHT_OPTION})
endif()

# proleg_compile_program_code(<target> <path>)
#   How the sources of a target that is no test are compiled: path is that of their folder below the top level.
function(proleg_compile_program_code target path)
  set(headers program_headers)
  if(path MATCHES "${PROLEG_LIGHT_ROOMS}")
    set(headers light_program_headers)
    if(path MATCHES "${PROLEG_NETWORK_ROOMS}")
      set(headers network_program_headers)
      target_compile_definitions(${target} PRIVATE BOOST_ALL_NO_LIB)  # as CMake's target of Boost has it
    endif()
    target_compile_options(${target} PRIVATE ${PROLEG_LIGHT_OPTION})
  endif()
  if(TARGET ${headers})
    target_precompile_headers(${target} REUSE_FROM ${headers})
  endif()
endfunction()
