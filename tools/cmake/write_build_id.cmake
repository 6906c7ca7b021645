# Writes the build id, taken from git, into a header; leaves the header alone if it says so already.
# Called at every build with SOURCE_DIR, VERSION and OUTPUT.
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --abbrev=12
  OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  set(revision "unknown")
endif()
set(text "#pragma once

namespace proleg::tools {

/// Version and git revision of this build.
inline constexpr const char* build_id = \"${VERSION}-${revision}\";

}  // namespace proleg::tools
")
set(old "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${OUTPUT} "${text}")
endif()
