# Prints what the program of a module takes of flash and RAM, and writes it beside the image.
# Called with PROGRAM, TOOL_PREFIX and OUTPUT.

function(run result)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

run(sections ${TOOL_PREFIX}size -B -d ${PROGRAM})
if(NOT sections MATCHES "\n *([0-9]+)[ \t]+([0-9]+)[ \t]+([0-9]+)")
  message(FATAL_ERROR "${PROGRAM}: found no sizes of sections, expected the output of size -B")
endif()
math(EXPR flash "${CMAKE_MATCH_1} + ${CMAKE_MATCH_2}")
run(symbols ${TOOL_PREFIX}nm -S --radix=d ${PROGRAM})
if(NOT symbols MATCHES "\n[0-9]+ 0*([0-9]+) [bB] the_module\n")
  message(FATAL_ERROR "${PROGRAM}: found no symbol the_module, expected an object of class Module")
endif()
set(ram ${CMAKE_MATCH_1})
message("firmware/module: ${flash} bytes code and constants, with all of shared that it needs; ${ram} bytes RAM (sizeof(Module))")
file(WRITE ${OUTPUT} "flash\t${flash}\nram\t${ram}\n")
