# Writes the build id, taken from git, into a header. Does not touch a header that already has it. Called at every build with
# SOURCE_DIR, VERSION and OUTPUT.
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --abbrev=12
  OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  set(revision "unknown")
elseif(revision MATCHES "-dirty$")
  execute_process(COMMAND git -C ${SOURCE_DIR} diff HEAD OUTPUT_VARIABLE changes ERROR_QUIET)
  string(SHA1 hash "${changes}")
  string(SUBSTRING ${hash} 0 8 hash)
  string(APPEND revision "-${hash}")
endif()
set(text "#define PROLEG_BUILD_ID \"${VERSION}-${revision}\"\n")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${text}" @ONLY)
