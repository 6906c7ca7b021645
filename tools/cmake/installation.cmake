# What `cmake --install build/host --prefix P` makes below P. Programs find their data from their own place
# (tools/proleg/common/installation.hpp), so that the prefix may be moved.
#   bin/proleg            the one program that users start, a link
#   lib/proleg/bin        all programs
#   lib/proleg/lib        plug-ins
#   share/proleg          scenarios, page, player, images
#   src/proleg, share/cmake, include
#                         for users' algorithms and plug-ins (development_files.cmake)
#   share/doc/proleg      documents: html/, if tools/docs --installed has made it, else as text
#   share/applications, share/icons
#                         the entry in the menu of a desktop
#   lib/udev/rules.d      rights and names of adapters
#   share/man, share/bash-completion, share/zsh, share/fish
#                         manual pages and completions, made of the help texts of the programs

# Components are the Debian packages (debian_packages.cmake): `runtime` for all that does not name another.

set(PROLEG_INSTALLED_PROGRAMS lib/proleg/bin)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME runtime)

if(PROLEG_TARGET)
  return()
endif()

# Manual pages and completions are made of what the programs print.
set(started_programs ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
if(CMAKE_CROSSCOMPILING)
  set(started_programs ${CMAKE_BINARY_DIR}/emulated)
endif()
# The page and the images are built by other commands.
install(CODE "
  foreach(needed \"build/page/index.html;tools/page\" \"build/player/player.html;tools/page\"
                 \"build/stm32f405/bin/proleg_stm32f405.pimg;cmake --preset stm32f405 && cmake --build --preset stm32f405\")
    list(GET needed 0 file)
    list(GET needed 1 command)
    if(NOT EXISTS \"${CMAKE_SOURCE_DIR}/\${file}\")
      message(FATAL_ERROR \"found no \${file}, expected it before an installation; this makes it: \${command}\")
    endif()
  endforeach()
  file(MAKE_DIRECTORY \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/bin\")
  execute_process(
    COMMAND python3 -B \"${CMAKE_SOURCE_DIR}/tools/docs.d/shell_files.py\" \"${started_programs}\"
            \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\"
    COMMAND_ERROR_IS_FATAL ANY)
  file(CREATE_LINK ../lib/proleg/bin/proleg \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/bin/proleg\" SYMBOLIC)
")

include(development_files)

install(DIRECTORY ${CMAKE_SOURCE_DIR}/sim/scenarios DESTINATION share/proleg)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/build/page ${CMAKE_SOURCE_DIR}/build/player DESTINATION share/proleg)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/build/stm32f405/bin/ DESTINATION share/proleg/images
  FILES_MATCHING PATTERN "proleg_*.pimg" PATTERN "proleg_*.elf" PATTERN "proleg_boot_*.bin")
install(FILES ${CMAKE_SOURCE_DIR}/host/desktop/proleg.desktop DESTINATION share/applications)
install(FILES ${CMAKE_SOURCE_DIR}/host/desktop/proleg.svg DESTINATION share/icons/hicolor/scalable/apps)
install(FILES ${CMAKE_SOURCE_DIR}/host/udev/70-proleg.rules DESTINATION lib/udev/rules.d)
# The site has the same pages and pictures. An installation from before may have had no site.
install(CODE "
  set(site \"${CMAKE_SOURCE_DIR}/build/docs_installed/site\")
  set(documents \"\${CMAKE_INSTALL_PREFIX}/share/doc/proleg\")
  if(EXISTS \"\${site}/index.html\")
    file(INSTALL DESTINATION \"\${documents}/html\" TYPE DIRECTORY FILES \"${CMAKE_SOURCE_DIR}/build/docs_installed/site/\")
  else()
    file(INSTALL DESTINATION \"\${documents}\" TYPE DIRECTORY FILES \"${CMAKE_SOURCE_DIR}/docs/\" PATTERN mkdocs.yml EXCLUDE)
  endif()
")
install(FILES ${CMAKE_SOURCE_DIR}/CHANGELOG.md DESTINATION share/doc/proleg)
# The licence of Proleg, and those of what its programs, images and page contain.
file(READ ${CMAKE_SOURCE_DIR}/LICENSE licence)
string(REGEX REPLACE "^[^\n]*\n\nCopyright \\(c\\) ([^\n]*)\n\n" "" licence "${licence}")
set(copyright ${CMAKE_MATCH_1})
string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REGEX REPLACE "\n(.)" "\n \\1" licence "${licence}")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/LICENSE)
configure_file(${CMAKE_SOURCE_DIR}/tools/release.d/copyright.in ${CMAKE_BINARY_DIR}/packages/copyright @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/packages/copyright DESTINATION share/doc/proleg)
