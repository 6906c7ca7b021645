# Algorithms of users' own (docs/user-algorithms.md): a folder that is not in this tree. For this tree, which builds them
# into its programs and images, and for the folder's own CMakeLists.txt, which makes a library of them.
#
# A folder has one source NAME.cpp, beside tests NAME_test.cpp and headers. It defines the function
#   const proleg::ActuationModule& proleg::user::NAME();
# whose declaration takes PROLEG_ALGORITHM_SOURCES.

# Compiles through ccache, if it is installed and can write to its folder: without that it ends the build.
macro(proleg_use_ccache)
  find_program(CCACHE_PROGRAM ccache)
  if(CCACHE_PROGRAM)
    execute_process(COMMAND ${CCACHE_PROGRAM} --get-config cache_dir OUTPUT_VARIABLE ccache_folder OUTPUT_STRIP_TRAILING_WHITESPACE)
    execute_process(COMMAND sh -c "\"$0\" -E make_directory \"$1/tmp\" && test -w \"$1/tmp\"" ${CMAKE_COMMAND} ${ccache_folder}
      RESULT_VARIABLE ccache_status OUTPUT_QUIET ERROR_QUIET)
    if(ccache_status EQUAL 0)
      set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
    endif()
  endif()
endmacro()

# proleg_find_user_algorithm(<folder> <prefix>)
#   Sets <prefix>_NAME, <prefix>_SOURCE (the file) and <prefix>_FINGERPRINT: the first 32 bits of the SHA-256 of the source
#   and of the headers, as 0x1234ABCD. A change of them configures the build again.
function(proleg_find_user_algorithm folder prefix)
  if(NOT IS_DIRECTORY ${folder})
    message(FATAL_ERROR "PROLEG_USER_ALGORITHMS: found no folder ${folder}, expected one that 'proleg new algorithm' has written")
  endif()
  file(GLOB sources ${folder}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(LENGTH sources count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR "${folder}: found ${count} sources, expected one NAME.cpp beside tests NAME_test.cpp")
  endif()
  cmake_path(GET sources STEM name)
  if(NOT name MATCHES "^[A-Za-z][A-Za-z0-9_]*$")
    message(FATAL_ERROR "${sources}: found the name ${name}, expected a letter, then letters, digits and _")
  endif()
  file(GLOB headers ${folder}/*.hpp)
  list(SORT headers)
  set(text "")
  foreach(file IN LISTS sources headers)
    file(SHA256 ${file} hash)
    cmake_path(GET file FILENAME file_name)
    string(APPEND text "${file_name} ${hash}\n")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  endforeach()
  string(SHA256 hash "${text}")
  string(SUBSTRING ${hash} 0 8 fingerprint)
  set(${prefix}_NAME ${name} PARENT_SCOPE)
  set(${prefix}_SOURCE ${sources} PARENT_SCOPE)
  set(${prefix}_FINGERPRINT 0x${fingerprint} PARENT_SCOPE)
endfunction()

# Writes a file that includes the algorithm's source, with its fingerprint. Sets `out` to it. text: what follows.
function(proleg_write_user_source prefix folder text out)
  set(file ${folder}/${${prefix}_NAME}.algorithm.cpp)
  file(CONFIGURE OUTPUT ${file} CONTENT "// Made by tools/cmake/user_algorithm.cmake.
#define PROLEG_ALGORITHM_SOURCES ${${prefix}_FINGERPRINT}U
#include \"${${prefix}_SOURCE}\"
${text}" @ONLY)
  set(${out} ${file} PARENT_SCOPE)
endfunction()

# proleg_user_algorithm_sources(<out>)
#   For shared/gait: sets `out` to the sources to compile for the algorithms in the folders PROLEG_USER_ALGORITHMS, in
#   place of gait/registry.cpp. Sets it to gait/registry.cpp if there are none.
function(proleg_user_algorithm_sources out)
  if(NOT PROLEG_USER_ALGORITHMS)
    set(${out} gait/registry.cpp PARENT_SCOPE)
    return()
  endif()
  set(build ${CMAKE_BINARY_DIR}/user_algorithms)
  cmake_path(SET tree NORMALIZE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../..)
  set(files)
  set(names)
  set(declarations "")
  set(table "")
  foreach(folder IN LISTS PROLEG_USER_ALGORITHMS)
    cmake_path(ABSOLUTE_PATH folder BASE_DIRECTORY ${CMAKE_SOURCE_DIR} NORMALIZE)
    proleg_find_user_algorithm(${folder} algorithm)
    if(algorithm_NAME IN_LIST names)
      message(FATAL_ERROR "PROLEG_USER_ALGORITHMS: found two algorithms ${algorithm_NAME}, expected different names")
    endif()
    list(APPEND names ${algorithm_NAME})
    proleg_write_user_source(algorithm ${build} "" file)
    list(APPEND files ${file})
    string(APPEND declarations "const ActuationModule& ${algorithm_NAME}();\n")
    string(APPEND table " user::${algorithm_NAME},")
  endforeach()
  set(registry ${build}/registry_with_users.cpp)
  file(CONFIGURE OUTPUT ${registry} CONTENT "// Made by tools/cmake/user_algorithm.cmake.
#include \"shared/gait/actuation_module.hpp\"
namespace proleg::user {
${declarations}}  // namespace proleg::user
#define PROLEG_USER_ALGORITHMS${table}
#include \"${tree}shared/gait/registry.cpp\"
" @ONLY)
  set_source_files_properties(${files} PROPERTIES COMPILE_OPTIONS -fsigned-char)
  list(JOIN names ", " listed)
  message(STATUS "Algorithms of users: ${listed}")
  set(${out} ${registry} ${files} PARENT_SCOPE)
endfunction()

# proleg_algorithm_project()
#   For the CMakeLists.txt of a user's folder, by find_package(Proleg): a library NAME.so for --algorithms; the test NAME_test, which
#   has the core and the algorithm (proleg::user::NAME()); and the target module-image, which is built when it is named: the image of
#   the modules with the algorithm, and their bootloader, in image/bin of the build folder. PROLEG_SOURCE is the folder with this tree.
macro(proleg_algorithm_project)
  proleg_find_user_algorithm(${CMAKE_CURRENT_SOURCE_DIR} algorithm)
  if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release)
  endif()
  set(CMAKE_CXX_STANDARD 20)
  set(CMAKE_CXX_STANDARD_REQUIRED ON)
  set(CMAKE_CXX_EXTENSIONS OFF)
  proleg_use_ccache()
  # As the core and the images: what compiles here compiles there. Without the option, char has a sign on x86-64, and none on ARM.
  add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast -ffp-contract=off -fsigned-char)
  file(GLOB core_sources ${PROLEG_SOURCE}/shared/fixed/*.cpp ${PROLEG_SOURCE}/shared/gait/*.cpp ${PROLEG_SOURCE}/shared/kernel/*.cpp)
  add_library(proleg_core STATIC ${core_sources})
  target_include_directories(proleg_core PUBLIC ${PROLEG_SOURCE})
  # The library exports its interface and nothing else: the core in it is not that of the program.
  set_target_properties(proleg_core PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_options(proleg_core PRIVATE -fno-exceptions -fno-rtti)

  proleg_write_user_source(algorithm ${CMAKE_CURRENT_BINARY_DIR} "
#include \"shared/computer/algorithm_library/algorithm_interface.hpp\"
extern \"C\" {
[[gnu::visibility(\"default\")]] extern const proleg::AlgorithmInterface proleg_algorithm_interface;
const proleg::AlgorithmInterface proleg_algorithm_interface =
    proleg::interface_of(PROLEG_ALGORITHM_SOURCES, proleg::user::${algorithm_NAME});
}
" library_source)
  add_library(${algorithm_NAME} MODULE ${library_source})
  set_target_properties(${algorithm_NAME} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_options(${algorithm_NAME} PRIVATE -fno-exceptions -fno-rtti)
  target_link_libraries(${algorithm_NAME} PRIVATE proleg_core)
  target_link_options(${algorithm_NAME} PRIVATE -Wl,--no-undefined -Wl,--exclude-libs,ALL)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64" AND NOT PROLEG_ALLOW_FLOATING_POINT)
    set(check ${CMAKE_CURRENT_BINARY_DIR}/${algorithm_NAME}.without_floating_point.o)
    add_custom_command(OUTPUT ${check}.checked
      COMMAND ${CMAKE_COMMAND} -D COMPILER=${CMAKE_CXX_COMPILER} -D SOURCE=${algorithm_SOURCE} -D TREE=${PROLEG_SOURCE} -D OBJECT=${check}
        -P ${PROLEG_SOURCE}/tools/cmake/check_floating_point.cmake
      DEPENDS ${library_source} ${algorithm_SOURCE}
      COMMENT "Looking for floating point in ${algorithm_NAME}"
      VERBATIM)
    add_custom_target(${algorithm_NAME}_uses_integers ALL DEPENDS ${check}.checked)
    add_dependencies(${algorithm_NAME} ${algorithm_NAME}_uses_integers)
  endif()

  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${algorithm_NAME}_test.cpp)
    enable_testing()
    add_library(tested_algorithm OBJECT ${library_source})
    target_include_directories(tested_algorithm PRIVATE ${PROLEG_SOURCE})
    target_compile_options(tested_algorithm PRIVATE -fno-exceptions -fno-rtti)
    add_executable(${algorithm_NAME}_test ${algorithm_NAME}_test.cpp)
    target_link_libraries(${algorithm_NAME}_test PRIVATE tested_algorithm proleg_core)
    add_test(NAME ${algorithm_NAME} COMMAND ${algorithm_NAME}_test)
  endif()

  add_custom_target(module-image
    COMMAND ${CMAKE_COMMAND} -D SOURCE=${PROLEG_SOURCE} -D BUILD=${CMAKE_CURRENT_BINARY_DIR}/image
            -D ALGORITHM=${CMAKE_CURRENT_SOURCE_DIR} -P ${PROLEG_SOURCE}/tools/cmake/build_module_image.cmake
    USES_TERMINAL VERBATIM)
endmacro()
