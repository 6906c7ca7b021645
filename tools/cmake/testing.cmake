# Tests mirror the tree: tests/shared/fixed holds the tests of shared/fixed, built into one program.

find_package(GTest REQUIRED)

# One ctest run tests the build folders of several presets; the prefix distinguishes their tests.
set(PROLEG_TEST_PREFIX "")
if(PROLEG_SANITIZE)
  set(PROLEG_TEST_PREFIX "asan.")
endif()

# Much of a test's compile time goes into optimising the comparisons of GoogleTest, most of it under the sanitizers. The
# rooms themselves are optimised in every preset.
set(PROLEG_TEST_OPTIONS -O1)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # At -O1 gcc 12 warns of std::string(n, c) + "text", which is right. It also warns of conversions of constants that fit,
  # for which clang, which compiles each of these sources under the sanitizers, looks at the value.
  list(APPEND PROLEG_TEST_OPTIONS -Wno-array-bounds -Wno-stringop-overflow -Wno-conversion -Wno-sign-conversion)
endif()
if(PROLEG_SANITIZE)
  set(PROLEG_TEST_OPTIONS -O0)
endif()

# Headers that nearly every test includes, compiled once.
if(PROLEG_PRECOMPILED_HEADERS)
  set(test_header_names <gtest/gtest.h> <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream>
      <functional> <memory> <optional> <random> <span> <sstream> <string> <string_view> <vector>)
  proleg_precompiled_headers(test_headers LIBRARIES GTest::gtest Eigen3::Eigen HEADERS ${test_header_names}
    OPTIONS ${PROLEG_TEST_OPTIONS})
  proleg_precompiled_headers(network_test_headers
    LIBRARIES GTest::gtest Eigen3::Eigen Boost::headers nlohmann_json::nlohmann_json
    HEADERS ${test_header_names} ${PROLEG_NETWORK_HEADERS}
    OPTIONS ${PROLEG_TEST_OPTIONS})
endif()

# Data that tests of any room may read. A change in them runs every test again, so docs/ is not among them.
set(PROLEG_TEST_DATA ${CMAKE_SOURCE_DIR}/sim/scenarios ${CMAKE_SOURCE_DIR}/tests)
# The interpreter itself: a version manager puts a script before it that takes longer to start than many a test.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
execute_process(COMMAND ${Python3_EXECUTABLE} -c "import sys; print(sys.executable)"
  OUTPUT_VARIABLE Python3_EXECUTABLE OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

# proleg_add_test(<name> COMMAND program [argument...] [PROGRAMS files...] [DATA paths...] [INSTALLS folders...] [COMPILES] [LABELS ...]
#                 [TIMEOUT seconds] [COST core-seconds] [ENVIRONMENT NAME=VALUE...] [HALF_CORES n] [VIRTUAL_TIME])
#   A ctest test whose result tools/check uses again while its inputs are the same (tools/run_test).
#   PROGRAMS   what the program starts: files, or $<TARGET_FILE:...>; a change in them runs the test again
#   DATA       what it reads, beside PROLEG_TEST_DATA: files, or folders with all that is below them but sources
#   INSTALLS   build folders that it installs (cmake --install): their scripts, and what these install
#   COMPILES   it compiles from the folders of DATA, so that their sources count too
#   COST       roughly, where it is many seconds: long tests start first
#   TIMEOUT    when it hangs: 15 times its cost, and 1200 at least, unless it is given
#   VIRTUAL_TIME  it and all that it starts run in virtual time (tests/support/virtual_time): no wait takes time of the computer,
#              and none ends earlier or later because the computer is slow or busy. For dynamically linked programs that wait by
#              poll, select, epoll, sleep, timer descriptors, semaphores or condition variables.
#   HALF_CORES what it keeps busy: 2 by default. ctest starts as many as fit (tools/check). A test that
#              needs more comes late, since smaller ones fit first.
set(PROLEG_HALF_CORES 2)
set(PROLEG_SHORTEST_TIMEOUT 1200)
function(proleg_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 test "VIRTUAL_TIME;COMPILES" "TIMEOUT;COST;HALF_CORES" "COMMAND;PROGRAMS;DATA;INSTALLS;LABELS;ENVIRONMENT")
  set(inputs)
  foreach(program IN LISTS test_PROGRAMS)
    list(APPEND inputs --program ${program})
  endforeach()
  foreach(data IN LISTS PROLEG_TEST_DATA test_DATA)
    list(APPEND inputs --data ${data})
  endforeach()
  foreach(build IN LISTS test_INSTALLS)
    list(APPEND inputs --installs ${build})
  endforeach()
  if(test_COMPILES)
    list(APPEND inputs --compiles)
  endif()
  if(test_VIRTUAL_TIME)
    # tools/run_test adds the first word of the command itself.
    list(GET test_COMMAND 0 program)
    list(APPEND inputs --program ${program} --program $<TARGET_FILE:virtual_time_clock>)
    list(PREPEND test_COMMAND $<TARGET_FILE:run_in_virtual_time> $<TARGET_FILE:virtual_time_clock>)
  endif()
  set(name ${PROLEG_TEST_PREFIX}${name})
  add_test(NAME ${name}
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/run_test --name ${name}
            --results ${CMAKE_BINARY_DIR}/test_results ${inputs} -- ${test_COMMAND})
  if(NOT test_TIMEOUT)
    set(test_TIMEOUT ${PROLEG_SHORTEST_TIMEOUT})
    if(test_COST)
      # A busy computer, or the sanitizers, may take ten times as long.
      math(EXPR test_TIMEOUT "${test_COST} * 15")
      if(test_TIMEOUT LESS PROLEG_SHORTEST_TIMEOUT)
        set(test_TIMEOUT ${PROLEG_SHORTEST_TIMEOUT})
      endif()
    endif()
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${test_TIMEOUT})
  if(PROLEG_SANITIZE)
    list(APPEND test_ENVIRONMENT
         "LSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/tests/leak_suppressions.txt:print_suppressions=0")
  endif()
  if(NOT test_HALF_CORES)
    set(test_HALF_CORES ${PROLEG_HALF_CORES})
  endif()
  set_tests_properties(${name} PROPERTIES PROCESSORS ${test_HALF_CORES})
  foreach(property IN ITEMS COST LABELS ENVIRONMENT)
    if(test_${property})
      set_tests_properties(${name} PROPERTIES ${property} "${test_${property}}")
    endif()
  endforeach()
endfunction()

# proleg_test(<path> SOURCES ... [DEPENDS rooms...] [LIBRARIES targets...] [SHARDS n] [options of proleg_add_test])
#   path     the tested room or subject, e.g. shared/fixed: one GoogleTest program, and one ctest test of that name (a
#            process for each case costs more than most cases)
#   SHARDS   run the cases as this many tests, for a program that takes long
#   ROBOTS   a GoogleTest filter of cases that simulate whole robots. Under the sanitizers they take ten times as long:
#            there they are slow tests. They run as built for users in every suite, also without PROLEG_UNIT_TESTS.
function(proleg_test path)
  cmake_parse_arguments(PARSE_ARGV 1 test "VIRTUAL_TIME" "TIMEOUT;COST;SHARDS;ROBOTS;HALF_CORES" "SOURCES;DEPENDS;LIBRARIES;PROGRAMS;DATA;LABELS")
  string(REPLACE "/" "_" name ${path})
  add_executable(${name}_test ${test_SOURCES})
  foreach(dependency IN LISTS test_DEPENDS)
    string(REPLACE "/" "_" dependency_target ${dependency})
    target_link_libraries(${name}_test PRIVATE proleg::${dependency_target})
  endforeach()
  target_link_libraries(${name}_test PRIVATE ${test_LIBRARIES} proleg::tests_support GTest::gtest GTest::gtest_main)
  target_compile_options(${name}_test PRIVATE ${PROLEG_TEST_OPTIONS})
  if(PROLEG_PRECOMPILED_HEADERS)
    set(headers test_headers)
    if(path MATCHES "^(host/(remote|robot|server|transport)|tools/proleg/ui)(/|$)")
      set(headers network_test_headers)
      target_compile_definitions(${name}_test PRIVATE BOOST_ALL_NO_LIB)  # as CMake's target of Boost has it
    endif()
    target_precompile_headers(${name}_test REUSE_FROM ${headers})
  endif()
  set(options PROGRAMS ${test_PROGRAMS} DATA ${test_DATA} LABELS ${test_LABELS} TIMEOUT ${test_TIMEOUT}
      COST ${test_COST} HALF_CORES ${test_HALF_CORES})
  if(test_VIRTUAL_TIME)
    list(APPEND options VIRTUAL_TIME)
  endif()
  set(command $<TARGET_FILE:${name}_test> --gtest_brief=1)
  if(test_ROBOTS AND PROLEG_SANITIZE)
    proleg_add_test(${path}.robots COMMAND ${command} --gtest_filter=${test_ROBOTS} PROGRAMS ${test_PROGRAMS} DATA ${test_DATA}
      LABELS slow TIMEOUT 3600)
    if(test_ROBOTS STREQUAL "*")
      return()
    endif()
    list(APPEND command --gtest_filter=-${test_ROBOTS})
  elseif(test_ROBOTS AND NOT PROLEG_UNIT_TESTS)
    list(APPEND command --gtest_filter=${test_ROBOTS})
  endif()
  if(NOT test_SHARDS)
    proleg_add_test(${path} COMMAND ${command} ${options})
    return()
  endif()
  math(EXPR last "${test_SHARDS} - 1")
  foreach(shard RANGE ${last})
    math(EXPR number "${shard} + 1")
    proleg_add_test(${path}.${number}of${test_SHARDS} COMMAND ${command} ${options}
      ENVIRONMENT GTEST_TOTAL_SHARDS=${test_SHARDS} GTEST_SHARD_INDEX=${shard})
  endforeach()
endfunction()

# proleg_fuzz_corpus(<name>)
#   Sets `corpus` to a folder of this name without files, for the seeds of a fuzz target.
macro(proleg_fuzz_corpus name)
  set(corpus ${CMAKE_CURRENT_BINARY_DIR}/${name})
  file(REMOVE_RECURSE ${corpus})
endmacro()

# proleg_fuzz_test(<path> SOURCE file ROOMS rooms... RUNS n MAX_LENGTH bytes [LIBRARIES targets...] [DICTIONARY file]
#                  [CORPUS folder] [LONG_RUNS n])
#   A libFuzzer program, PATH_fuzz with underscores, and the test PATH.fuzz: a fixed number of inputs from a fixed seed. A
#   longer search, for example for host/flash:
#     build/asan/bin/host_flash_fuzz -max_len=600 -max_total_time=3600 FOLDER_FOR_NEW_INPUTS build/asan/tests/host/flash/fuzz/corpus
#   ROOMS      guide the fuzzer: they get counters of the code that an input reaches
#   CORPUS     seeds, made before this call
#   LONG_RUNS  a second, slow test with other inputs
function(proleg_fuzz_test path)
  cmake_parse_arguments(PARSE_ARGV 1 fuzz "" "SOURCE;RUNS;MAX_LENGTH;DICTIONARY;CORPUS;LONG_RUNS" "ROOMS;LIBRARIES")
  string(REPLACE "/" "_" name ${path})
  add_executable(${name}_fuzz ${fuzz_SOURCE})
  target_compile_options(${name}_fuzz PRIVATE -fsanitize=fuzzer)
  target_link_options(${name}_fuzz PRIVATE -fsanitize=fuzzer)
  target_link_libraries(${name}_fuzz PRIVATE ${fuzz_LIBRARIES} proleg::tests_support)
  foreach(room IN LISTS fuzz_ROOMS)
    string(REPLACE "/" "_" target ${room})
    # -fsanitize=fuzzer-no-link adds the same counters, but rejects the precompiled headers.
    target_compile_options(${target} PRIVATE -fsanitize-coverage=inline-8bit-counters,indirect-calls,trace-cmp,pc-table)
    target_link_libraries(${name}_fuzz PRIVATE proleg::${target})
  endforeach()
  set(command $<TARGET_FILE:${name}_fuzz> -max_len=${fuzz_MAX_LENGTH} -timeout=60
      -artifact_prefix=${CMAKE_CURRENT_BINARY_DIR}/)
  if(fuzz_DICTIONARY)
    list(APPEND command -dict=${CMAKE_CURRENT_SOURCE_DIR}/${fuzz_DICTIONARY})
  endif()
  if(fuzz_CORPUS)
    file(GLOB seeds ${fuzz_CORPUS}/*)
    list(JOIN seeds "," seed_inputs)
    list(APPEND command -seed_inputs=${seed_inputs})
  endif()
  proleg_add_test(${path}.fuzz COMMAND ${command} -runs=${fuzz_RUNS} -seed=1 DATA ${fuzz_CORPUS})
  if(fuzz_LONG_RUNS)
    proleg_add_test(${path}.fuzz_long COMMAND ${command} -runs=${fuzz_LONG_RUNS} -seed=2 DATA ${fuzz_CORPUS}
      LABELS slow TIMEOUT 3600)
  endif()
endfunction()
