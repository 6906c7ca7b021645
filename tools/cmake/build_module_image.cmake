# Builds the image of the modules with an algorithm of a user: the target module-image (user_algorithm.cmake). The build is one of its
# own, because the compiler is another.
#   cmake -D SOURCE=tree -D BUILD=folder -D ALGORITHM=folder -P build_module_image.cmake

include(${SOURCE}/tools/toolchains/stm32f405.cmake)  # here a missing compiler is one error
# CMake refuses the build of other sources, such as those of a checkout after an installation.
if(EXISTS ${BUILD}/CMakeCache.txt)
  file(STRINGS ${BUILD}/CMakeCache.txt before REGEX "^CMAKE_HOME_DIRECTORY:")
  if(NOT before STREQUAL "CMAKE_HOME_DIRECTORY:INTERNAL=${SOURCE}")
    file(REMOVE_RECURSE ${BUILD})
  endif()
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} --preset stm32f405 -B ${BUILD} -D PROLEG_USER_ALGORITHMS=${ALGORITHM}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --target proleg_stm32f405 proleg_boot_stm32f405
  COMMAND_ERROR_IS_FATAL ANY)
message(STATUS "The image is ${BUILD}/bin/proleg_stm32f405.pimg")
