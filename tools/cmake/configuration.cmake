# A configuration that fails leaves a build folder as it was: its options keep the values of the last one that succeeded. So
# `cmake --build` goes on there, for example after `cmake --preset host` without the packages of the tests.

set(proleg_kept_options PROLEG_TESTS PROLEG_UNIT_TESTS PROLEG_BENCHMARKS PROLEG_PRECOMPILED_HEADERS CMAKE_UNITY_BUILD)

# Before the options are read: the cache, which CMake writes in any case, gets the old values; the new ones are variables.
macro(proleg_begin_configuration)
  foreach(option IN LISTS proleg_kept_options)
    if(DEFINED CACHE{${option}} AND DEFINED PROLEG_LAST_${option})
      set(wanted $CACHE{${option}})
      set(${option} ${PROLEG_LAST_${option}} CACHE BOOL "" FORCE)
      set(${option} ${wanted})
    endif()
  endforeach()
endmacro()

# At the end of the configuration.
macro(proleg_finish_configuration)
  foreach(option IN LISTS proleg_kept_options)
    if(DEFINED ${option})
      set(${option} ${${option}} CACHE BOOL "" FORCE)
      set(PROLEG_LAST_${option} ${${option}} CACHE INTERNAL "")
    endif()
  endforeach()
endmacro()

option(PROLEG_PACKAGE_CHECK "Say which Debian packages are missing, where there is dpkg" ON)

# Ends with the names of the Debian packages that are missing, and the command that installs them. Looks only at the first
# configuration, and when tests are switched on, because other sources of the libraries are as good.
function(proleg_check_packages)
  find_program(PROLEG_DPKG_QUERY dpkg-query)
  if(NOT PROLEG_PACKAGE_CHECK OR NOT PROLEG_DPKG_QUERY OR PROLEG_LAST_PROLEG_TESTS STREQUAL "${PROLEG_TESTS}")
    return()
  endif()
  set(lists "\${build_packages[@]}")
  set(purpose "the programs")
  set(others "")
  if(PROLEG_TESTS)
    string(APPEND lists " \${test_packages[@]}")
    set(purpose "the programs and their tests")
    set(others "\n'tools/check' installs them, too. The programs without tests need fewer:\n  cmake --preset programs")
  endif()
  execute_process(COMMAND bash -c "source tools/packages.sh && missing_packages ${lists}"
    WORKING_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE missing OUTPUT_STRIP_TRAILING_WHITESPACE
    COMMAND_ERROR_IS_FATAL ANY)
  if(missing)
    string(REPLACE "\n" " " missing "${missing}")
    message(FATAL_ERROR "Debian packages that ${purpose} need are not installed. This command installs them:\n"
      "  sudo apt-get install --no-install-recommends ${missing}${others}\n"
      "If the libraries are here without the packages: -D PROLEG_PACKAGE_CHECK=OFF")
  endif()
endfunction()
