# The sources of a target are compiled as one text: the templates that several of them use are compiled once. That
# makes a whole build shorter, so tools/check does it, and the build after a change of one file longer.
option(PROLEG_ONE_TEXT "Compile the sources of each target as one text" OFF)

if(PROLEG_ONE_TEXT AND NOT CMAKE_CROSSCOMPILING)
  set(CMAKE_UNITY_BUILD ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 0)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC takes the sources of such a text for headers: their anonymous namespaces would be in several texts.
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
  endif()
endif()

# proleg_few_texts(<target>...)
#   Targets whose sources do not compile as one text, but as texts of ten: some give the same name to different things.
function(proleg_few_texts)
  set_target_properties(${ARGN} PROPERTIES UNITY_BUILD_BATCH_SIZE 10)
endfunction()

# proleg_separate(<source>...)
#   Sources of the current folder that do not compile as one text with others: their files give the same name to different
#   things.
function(proleg_separate)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
