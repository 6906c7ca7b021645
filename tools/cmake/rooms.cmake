# A room is a folder with one library target. A header is reachable only as "shared/fixed/sine.hpp", and only for
# targets that name the room as a dependency: each room's include directory holds nothing but a link to that room,
# so an include that architecture.md forbids does not compile.

# proleg_room(<path> [SOURCES ...] [DEPENDS ...] [LIBRARIES ...] [PRIVATE_LIBRARIES ...])
#   path       folder below the top level, e.g. shared/fixed; the target is called proleg::shared_fixed
#   DEPENDS    other rooms, by path; targets that depend on this room can include them too
#   LIBRARIES  library targets from outside the project; PRIVATE_LIBRARIES: those that only this room may name
function(proleg_room path)
  cmake_parse_arguments(PARSE_ARGV 1 room "" "" "SOURCES;DEPENDS;LIBRARIES;PRIVATE_LIBRARIES")
  string(REPLACE "/" "_" target ${path})
  cmake_path(GET path PARENT_PATH parent)
  set(include_dir ${CMAKE_BINARY_DIR}/rooms/${target})
  file(MAKE_DIRECTORY ${include_dir}/${parent})
  file(CREATE_LINK ${CMAKE_SOURCE_DIR}/${path} ${include_dir}/${path} SYMBOLIC)

  if(room_SOURCES)
    add_library(${target} STATIC ${room_SOURCES})
    set(scope PUBLIC)
    if(path MATCHES "^(sim|host|tools|shared/computer)/" AND NOT PROLEG_TARGET)
      proleg_compile_program_code(${target} ${path})
    endif()
    if(path MATCHES "^(shared|firmware)/" AND NOT path MATCHES "^shared/computer/")
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${PROLEG_CORE_OPTIONS}>)
    endif()
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(proleg::${target} ALIAS ${target})
  target_include_directories(${target} ${scope} ${include_dir})
  foreach(dependency IN LISTS room_DEPENDS)
    string(REPLACE "/" "_" dependency_target ${dependency})
    target_link_libraries(${target} ${scope} proleg::${dependency_target})
  endforeach()
  target_link_libraries(${target} ${scope} ${room_LIBRARIES})
  if(room_PRIVATE_LIBRARIES)
    target_link_libraries(${target} PRIVATE ${room_PRIVATE_LIBRARIES})
  endif()
endfunction()
