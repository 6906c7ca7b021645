# Writes a header with the git commit of the sources of an image, if that has changed: the last commit of the folders
# that an image is built from, and whether they differ from it. Without git: 20 zeros. Installed sources have such a header, written
# at their installation. HAS_USER_ALGORITHMS: the image has algorithms of users, so its sources are more than those of the commit.
#   cmake -D SOURCE_DIR=... -D HAS_USER_ALGORITHMS=... -D OUTPUT=... -P write_image_commit.cmake

set(folders shared firmware tools/cmake tools/toolchains CMakeLists.txt CMakePresets.json)
execute_process(COMMAND git -C ${SOURCE_DIR} log -1 --format=%H -- ${folders}
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
execute_process(COMMAND git -C ${SOURCE_DIR} status --porcelain -- ${folders}
  OUTPUT_VARIABLE changes OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT status EQUAL 0 OR NOT commit MATCHES "^[0-9a-f]+$")
  string(REPEAT "0" 40 commit)
  set(changes "")
endif()
string(REGEX REPLACE "(..)" "0x\\1, " bytes ${commit})
set(has_changes false)
if(changes OR HAS_USER_ALGORITHMS)
  set(has_changes true)
endif()
set(text "#define PROLEG_IMAGE_COMMIT {${bytes}}\n#define PROLEG_IMAGE_HAS_CHANGES ${has_changes}\n")
if(EXISTS ${SOURCE_DIR}/image_commit.hpp)
  file(READ ${SOURCE_DIR}/image_commit.hpp text)
  if(HAS_USER_ALGORITHMS)
    string(REPLACE "HAS_CHANGES false" "HAS_CHANGES true" text "${text}")
  endif()
endif()
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUTPUT} "${text}")
endif()
