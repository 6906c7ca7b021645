// Programs in which every instruction matters. The test puts them into the vector table.

#include "macros.inc"

// Sets every register to another value, sets N, C, Q and GE, and polls for an interrupt.
function distinct_registers
  ldr r0, =0xA80F0000
  msr apsr_nzcvqg, r0
  ldr r0, =0x10000000
  ldr r1, =0x11111111
  ldr r2, =0x12222222
  ldr r3, =0x13333333
  ldr r4, =0x14444444
  ldr r5, =0x15555555
  ldr r6, =0x16666666
  ldr r7, =0x17777777
  ldr r8, =0x18888888
  ldr r9, =0x19999999
  ldr r10, =0x1AAAAAAA
  ldr r11, =0x1BBBBBBB
  ldr r12, =0x1CCCCCCC
  ldr lr, =0x1EEEEEEE
  .global distinct_registers_loop
  .thumb_func
distinct_registers_loop:
  nop
  b distinct_registers_loop
end_function distinct_registers

// The same on the process stack, privileged.
function distinct_registers_on_process_stack
  ldr r0, =0x20008000
  msr psp, r0
  movs r0, #2
  msr control, r0
  isb
  b distinct_registers
end_function distinct_registers_on_process_stack

// The same on the process stack, unprivileged.
function distinct_registers_unprivileged
  ldr r0, =0x20008000
  msr psp, r0
  movs r0, #3
  msr control, r0
  isb
  b distinct_registers
end_function distinct_registers_unprivileged

// The same on a main stack that is not aligned to 8 bytes.
function distinct_registers_on_odd_stack
  sub sp, sp, #4
  b distinct_registers
end_function distinct_registers_on_odd_stack

// A handler that overwrites all that the hardware saves, marks the registers at its entry, and returns.
function reporting_handler
  ldr r0, =mark_port
  str lr, [r0]
  mrs r1, msp
  str r1, [r0]
  mrs r1, psp
  str r1, [r0]
  mrs r1, xpsr
  str r1, [r0]
  mrs r1, control
  str r1, [r0]
  ldr r0, =0x0
  msr apsr_nzcvqg, r0
  mov r1, r0
  mov r2, r0
  mov r3, r0
  mov r12, r0
  bx lr
end_function reporting_handler

// A handler that returns by POP, as compilers do.
function popping_handler
  push {r4, lr}
  movs r4, #7
  pop {r4, pc}
end_function popping_handler

// A handler that returns by LDM with an offset.
function ldm_handler
  push {r4-r6, lr}
  movs r4, #7
  ldmia sp!, {r4-r6, pc}
end_function ldm_handler

// A handler that marks r0 to r3 as it finds them.
function register_handler
  ldr r12, =mark_port
  str r0, [r12]
  str r1, [r12]
  str r2, [r12]
  str r3, [r12]
  bx lr
end_function register_handler

// SVC 42 with arguments; marks what the handler leaves in the frame's r0.
function calls_supervisor
  movs r0, #1
  movs r1, #2
  svc #42
  ldr r1, =mark_port
  str r0, [r1]
1:
  wfi
  b 1b
end_function calls_supervisor

// Marks the number of the SVC, and returns r0 + r1 to the caller.
function supervisor
  tst lr, #4
  ite eq
  mrseq r0, msp
  mrsne r0, psp
  ldr r1, [r0, #24]
  ldrb r1, [r1, #-2]
  ldr r2, =mark_port
  str r1, [r2]
  ldr r1, [r0]
  ldr r3, [r0, #4]
  add r1, r1, r3
  str r1, [r0]
  bx lr
end_function supervisor

// Three stores to registers in one block, and one that raises interrupt 3 in between.
function stores_once
  cpsie i
  ldr r0, =mark_port
  ldr r1, =0xE000E100
  movs r2, #8
  str r2, [r1]
  movs r3, #1
  str r3, [r0]
  ldr r4, =0xE000E200
  str r2, [r4]
  movs r3, #2
  str r3, [r0]
  strh r3, [r0, #4]
  strb r3, [r0, #8]
  movs r3, #3
  str r3, [r0]
1:
  wfi
  b 1b
end_function stores_once

// WFI with interrupts masked: r4 counts how often it was passed.
function sleeps_masked
  cpsid i
  movs r4, #0
  wfi
  adds r4, r4, #1
  ldr r0, =mark_port
  str r4, [r0]
  cpsie i
  adds r4, r4, #1
  str r4, [r0]
1:
  wfi
  b 1b
end_function sleeps_masked

// WFI in an IT block, once with its condition false and once with it true.
function sleeps_conditionally
  ldr r0, =mark_port
  movs r1, #1
  cmp r1, #2
  it eq
  wfieq
  str r1, [r0]
  cmp r1, #1
  it eq
  wfieq
  movs r1, #2
  str r1, [r0]
1:
  wfi
  b 1b
end_function sleeps_conditionally

// SEV, WFE, WFE: the first does not sleep.
function waits_for_events
  ldr r0, =mark_port
  movs r1, #1
  wfe
  sev
  wfe
  str r1, [r0]
  wfe
  movs r1, #2
  str r1, [r0]
1:
  wfe
  b 1b
end_function waits_for_events

// YIELD does nothing.
function yields
  ldr r0, =mark_port
  movs r1, #1
  yield
  str r1, [r0]
  movs r1, #2
  yield
  yield
  str r1, [r0]
1:
  wfi
  b 1b
end_function yields

// 64 bits long; exactly 1,000,001 instructions, of 2 and 4 bytes, up to and with the WFI. r0: rounds, 200,000.
function counted_loop
  ldr r0, =199999
1:
  adds r1, r1, #1
  add.w r2, r2, r1
  nop
  subs r0, r0, #1
  bne 1b
  nop
  nop
  nop
  nop
  wfi
1:
  b 1b
end_function counted_loop

// An IT block that crosses a page of 4 KB, where the emulator cuts its blocks: an interrupt between its instructions
// must leave the rest conditional.
  .section .text.it_across_pages, "ax", %progbits
  .balign 4096
  .space 4096 - 16
  .global it_across_pages
  .type it_across_pages, %function
  .thumb_func
it_across_pages:
  ldr r0, =mark_port      // 4096 - 16
  ldr r1, =5
  movs r2, #0
  cmp r1, #5
  nop
  itttt ne
  movne r2, #1
  movne r2, #2
  movne r2, #3            // 4096
  movne r2, #4
  str r2, [r0]
  cmp r1, #5
1:
  wfi
  b 1b
  .ltorg
  .size it_across_pages, . - it_across_pages

// Calls code that the test writes to r4, with a return by BX LR, again and again, and marks what it returns.
function calls_written_code
  ldr r4, =0x08040001
  ldr r5, =mark_port
1:
  blx r4
  str r0, [r5]
  wfi
  b 1b
end_function calls_written_code

// Writes a function that returns r0 = 1 to RAM and calls it, then one that returns 2 at the same place.
function calls_code_in_ram
  ldr r4, =0x20001000
  ldr r5, =mark_port
  ldr r0, =0x47702001     // movs r0, #1; bx lr
  str r0, [r4]
  dsb
  isb
  adds r6, r4, #1
  blx r6
  str r0, [r5]
  ldr r0, =0x47702002
  str r0, [r4]
  dsb
  isb
  blx r6
  str r0, [r5]
1:
  wfi
  b 1b
end_function calls_code_in_ram

// Stores to flash and reads back, with other stores around it.
function stores_to_flash
  ldr r0, =mark_port
  ldr r1, =0x08040000
  ldr r2, =0x12345678
  movs r3, #1
  str r3, [r0]
  str r2, [r1]
  movs r3, #2
  str r3, [r0]
  b 1f
1:
  ldr r2, [r1]
  str r2, [r0]
2:
  wfi
  b 2b
end_function stores_to_flash

// Writes code into flash, calls it, overwrites it, calls it again.
function programs_itself
  ldr r4, =0x08040000
  ldr r5, =mark_port
  ldr r0, =0x47702001     // movs r0, #1; bx lr
  str r0, [r4]
  dsb
  isb
  adds r6, r4, #1
  blx r6
  str r0, [r5]
  ldr r0, =0x47702002
  str r0, [r4]
  dsb
  isb
  blx r6
  str r0, [r5]
1:
  wfi
  b 1b
end_function programs_itself

// Bit-band aliases of RAM and of a peripheral.
function uses_bits
  ldr r0, =0x20001000
  ldr r1, =0xFFFF0000
  str r1, [r0]
  ldr r2, =0x22020000     // bit 0 of 0x20001000
  movs r3, #1
  str r3, [r2, #4]        // bit 1
  movs r3, #0
  str r3, [r2, #124]      // bit 31
  ldr r4, =mark_port
  ldr r1, [r0]
  str r1, [r4]
  ldr r1, [r2, #64]       // bit 16
  str r1, [r4]
  ldr r2, =0x42002000     // bit 0 of 0x40000100
  movs r3, #1
  str r3, [r2, #20]       // bit 5
  ldr r1, =0x40000100
  ldr r1, [r1]
  str r1, [r4]
1:
  wfi
  b 1b
end_function uses_bits

// One interrupt wake-up of a benchmark: 750 instructions or so in the handler, 10 in the loop.
function benchmark_handler
  push {r4-r6, lr}
  ldr r4, =0x20000100
  movs r5, #0
  movs r6, #120
1:
  ldr r0, [r4, r5]
  adds r0, r0, #1
  str r0, [r4, r5]
  adds r5, r5, #4
  subs r6, r6, #1
  bne 1b
  pop {r4-r6, pc}
end_function benchmark_handler

function short_handler
  bx lr
end_function short_handler

// Enables interrupt 3 and sleeps without end.
function sleeps
  ldr r0, =0xE000E100
  movs r1, #8
  str r1, [r0]
1:
  wfi
  b 1b
end_function sleeps

function spins
  cpsie i
1:
  b 1b
end_function spins

function compute_loop
  ldr r4, =0x20000100
  movs r0, #0
1:
  adds r0, r0, #1
  eor r1, r1, r0, lsl #3
  mul r2, r1, r0
  str r2, [r4]
  ldr r3, [r4, #4]
  add r3, r3, r2
  str r3, [r4, #4]
  b 1b
end_function compute_loop
