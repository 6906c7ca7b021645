# What users' algorithms, plug-ins and images for modules are built from, below a prefix; the Debian package proleg-dev.
#   src/proleg            a part of this tree: the core, the firmware, and what builds them. It is complete for the presets
#                         stm32f405 and cortex-m0, for `proleg verify` and for find_package(Proleg)
#   share/cmake/Proleg    where CMake finds the package
#   include/proleg        a link to src/proleg, for compilers that are called without CMake

set(development DESTINATION src/proleg COMPONENT dev)
install(FILES ${CMAKE_SOURCE_DIR}/CMakeLists.txt ${CMAKE_SOURCE_DIR}/CMakePresets.json ${development})
install(DIRECTORY ${CMAKE_SOURCE_DIR}/shared ${CMAKE_SOURCE_DIR}/firmware ${development}
  PATTERN computer EXCLUDE PATTERN stm32f405/board EXCLUDE PATTERN make_board_record.py EXCLUDE PATTERN __pycache__ EXCLUDE)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/tests/cortex_m/image DESTINATION src/proleg/tests/cortex_m COMPONENT dev)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/tests/identity DESTINATION src/proleg/tests COMPONENT dev
  FILES_MATCHING PATTERN "identity_case.*" PATTERN "sensing_probe.*" PATTERN variant_main.cpp PATTERN user_variants/CMakeLists.txt
  PATTERN arm64 EXCLUDE PATTERN verify EXCLUDE)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/tools/cmake ${CMAKE_SOURCE_DIR}/tools/toolchains DESTINATION src/proleg/tools COMPONENT dev
  PATTERN "*debian_packages.cmake" EXCLUDE PATTERN arm64.cmake EXCLUDE)
install(PROGRAMS ${CMAKE_SOURCE_DIR}/tools/stack_bound DESTINATION src/proleg/tools COMPONENT dev)
foreach(header shared/computer/algorithm_library/algorithm_interface.hpp host/robot_control_abi/robot_control.h)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${CMAKE_SOURCE_DIR}/${header} DESTINATION src/proleg/${folder} COMPONENT dev)
endforeach()
install(FILES ${CMAKE_SOURCE_DIR}/tools/cmake/ProlegConfig.cmake ${CMAKE_SOURCE_DIR}/tools/cmake/ProlegConfigVersion.cmake
  DESTINATION share/cmake/Proleg COMPONENT dev)
# Programs compare the id of their build with this one. Images name the commit of their sources, of which git knows nothing there.
install(FILES ${CMAKE_BINARY_DIR}/build_id_text/build_id_text.hpp ${development})
install(CODE "
  set(development \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
  execute_process(
    COMMAND \"${CMAKE_COMMAND}\" -D \"SOURCE_DIR=${CMAKE_SOURCE_DIR}\" -D HAS_USER_ALGORITHMS=OFF
            -D \"OUTPUT=\${development}/src/proleg/image_commit.hpp\" -P \"${CMAKE_SOURCE_DIR}/tools/cmake/write_image_commit.cmake\"
    COMMAND_ERROR_IS_FATAL ANY)
  file(MAKE_DIRECTORY \"\${development}/include\")
  file(CREATE_LINK ../src/proleg \"\${development}/include/proleg\" SYMBOLIC)
" COMPONENT dev)
