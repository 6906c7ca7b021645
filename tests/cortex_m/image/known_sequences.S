// Short functions whose instructions and stack are known by counting lines: what the harness is tested against.
// They run on Cortex-M0 and Cortex-M4 alike.

  .syntax unified
  .thumb
  .text

.macro function name
  .section .text.\name, "ax", %progbits
  .global \name
  .type \name, %function
  .thumb_func
\name:
.endm

.macro end_function name
  .size \name, . - \name
.endm

// 7 instructions, two of them of 4 bytes. Returns r0 + r1 + r2 + r3.
function known_sum
  adds r0, r0, r1
  mrs r1, apsr
  adds r0, r0, r2
  dmb
  adds r0, r0, r3
  nop
  bx lr
end_function known_sum

// 2 instructions a round and one to return. r0: rounds.
function known_loop
1:
  subs r0, r0, #1
  bne 1b
  bx lr
end_function known_loop

// 4 instructions; 24 bytes of stack.
function known_stack
  push {r4-r7, lr}
  sub sp, sp, #4
  add sp, sp, #4
  pop {r4-r7, pc}
end_function known_stack

// Never returns.
function known_endless
1:
  b 1b
end_function known_endless

// Writes where no memory is.
function known_bad_write
  movs r1, #0
  ldr r2, =0x60000000
  str r1, [r2]
  bx lr
end_function known_bad_write

// Jumps where no memory is.
function known_bad_jump
  ldr r2, =0x60000001
  bx r2
end_function known_bad_jump

// An instruction that does not exist.
function known_undefined
  udf #0
  bx lr
end_function known_undefined

// Puts more on the stack than there is.
function known_overflow
1:
  push {r0-r7}
  b 1b
end_function known_overflow

// Returns its fifth argument.
function known_fifth
  ldr r0, [sp]
  bx lr
end_function known_fifth

// Writes to flash.
function known_flash_write
  movs r1, #0
  ldr r2, =0x08000000
  str r1, [r2]
  bx lr
end_function known_flash_write
