# find_package(Proleg): for projects outside of this tree. A checkout has it here; an installation has it in share/cmake/Proleg too,
# and its sources in src/proleg (development_files.cmake).
#
#   proleg_algorithm_project()           the library, the test and the image of an algorithm (docs/user-algorithms.md)
#   proleg_add_plugin(NAME SOURCE ...)   proleg-NAME.so, which drives a robot without modules (docs/robot-control.md)
#   Proleg::robot_control                the header of such plug-ins, "host/robot_control_abi/robot_control.h"
#   PROLEG_SOURCE                        the folder of the sources

cmake_path(SET PROLEG_SOURCE NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../..")
if(NOT EXISTS ${PROLEG_SOURCE}/shared/gait)
  cmake_path(SET PROLEG_SOURCE NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../../../src/proleg")
endif()
string(REGEX REPLACE "/$" "" PROLEG_SOURCE "${PROLEG_SOURCE}")
include(${PROLEG_SOURCE}/tools/cmake/user_algorithm.cmake)

if(NOT TARGET Proleg::robot_control)
  add_library(Proleg::robot_control INTERFACE IMPORTED)
  target_include_directories(Proleg::robot_control INTERFACE ${PROLEG_SOURCE})
endif()

# Programs find a plug-in by the name of its file.
function(proleg_add_plugin name)
  add_library(proleg-${name} MODULE ${ARGN})
  set_target_properties(proleg-${name} PROPERTIES PREFIX "")
  target_link_libraries(proleg-${name} PRIVATE Proleg::robot_control)
  target_link_options(proleg-${name} PRIVATE -Wl,--exclude-libs,ALL)
endfunction()
