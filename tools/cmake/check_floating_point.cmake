# Fails if an algorithm of a user computes with floating point: other processors would give other bits. It compiles the source for an
# x86-64 processor without registers for it: then GCC reports an error, or calls functions of its own for the operations.
# Used by user_algorithm.cmake; cmake -D COMPILER=g++ -D SOURCE=file -D TREE=checkout -D OBJECT=file -P this file

execute_process(COMMAND ${COMPILER} -std=c++20 -O2 -w -fno-exceptions -fno-rtti -mgeneral-regs-only -DPROLEG_ALGORITHM_SOURCES=1U
    -I${TREE} -c ${SOURCE} -o ${OBJECT}
  RESULT_VARIABLE status ERROR_VARIABLE error)
set(use "")
if(status EQUAL 0)
  execute_process(COMMAND nm --undefined-only ${OBJECT} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCH "__(add|sub|mul|div|neg|fix|fixuns|float|floatun|extend|trunc|cmp|unord|eq|ne|ge|lt|le|gt)[sdtx][fi][a-z0-9]*"
    use "${symbols}")
elseif(error MATCHES "([^\n]*): error: [^\n]*(SSE|x87|SIMD)")  # other errors are those of the ordinary build
  set(use "${CMAKE_MATCH_1}")
endif()
if(use)
  message(FATAL_ERROR "${SOURCE}: found floating point (${use}), expected integers alone: other processors would compute other bits. "
    "shared/fixed has arithmetic and sines of integers.")
endif()
file(TOUCH ${OBJECT}.checked)
