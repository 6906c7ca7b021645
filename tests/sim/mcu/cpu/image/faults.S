// Instructions that cause faults. Each function has that instruction at the label with _here.

#include "macros.inc"

.macro here name
  .global \name\()_here
\name\()_here:
.endm

function undefined_instruction
  ldr r0, =mark_port
  movs r1, #1
  str r1, [r0]
  here undefined_instruction
  udf #0
  movs r1, #2
  str r1, [r0]
1:
  b 1b
end_function undefined_instruction

function bad_jump
  ldr r0, =0x60000001
  bx r0
end_function bad_jump

function null_call
  movs r0, #0
  blx r0
end_function null_call

function null_call_in_thumb_state
  movs r0, #1
  blx r0
end_function null_call_in_thumb_state

function jump_to_peripheral
  ldr r0, =0x40000001
  bx r0
end_function jump_to_peripheral

function jump_to_ccm
  ldr r0, =0x10000001
  bx r0
end_function jump_to_ccm

function jump_to_even
  ldr r0, =short_handler
  bic r0, r0, #1
  bx r0
end_function jump_to_even

function unaligned_exclusive
  ldr r0, =0x20001002
  nop
  here unaligned_exclusive
  ldrex r1, [r0]
  nop
1:
  b 1b
end_function unaligned_exclusive

function false_return
  ldr r0, =0xFFFFFFF9
  bx r0
end_function false_return

function breaks
  nop
  here breaks
  bkpt #0
  nop
end_function breaks

function uses_fpu
  ldr r0, =mark_port
  movs r1, #1
  str r1, [r0]
  here uses_fpu
  vmov s0, r1
  vadd.f32 s0, s0, s0
  vmov r1, s0
  str r1, [r0]
1:
  wfi
  b 1b
end_function uses_fpu

function allows_and_uses_fpu
  ldr r0, =0xE000ED88
  ldr r1, =0x00F00000
  str r1, [r0]
  dsb
  isb
  ldr r1, =0x3F800000
  ldr r0, =mark_port
  vmov s0, r1
  vadd.f32 s0, s0, s0
  vmov r1, s0
  str r1, [r0]
1:
  wfi
  b 1b
end_function allows_and_uses_fpu

function faulting_handler
  here faulting_handler
  udf #0
end_function faulting_handler

function bad_exc_return
  ldr lr, =0xFFFFFFF1
  bx lr
end_function bad_exc_return

// Continues behind the instruction of 2 bytes that caused it.
function skipping_handler
  ldr r0, [sp, #24]
  adds r0, r0, #2
  str r0, [sp, #24]
  bx lr
end_function skipping_handler

function stack_overflow
1:
  push {r0-r7}
  b 1b
end_function stack_overflow

// A fault in a block with a store to a register before it and behind it.
function faults_between_stores
  ldr r0, =mark_port
  ldr r1, =0x60000000
  movs r2, #1
  str r2, [r0]
  movs r2, #2
  str r2, [r0]
  here faults_between_stores
  ldr r3, [r1]
  movs r2, #3
  str r2, [r0]
1:
  wfi
  b 1b
end_function faults_between_stores

// Loads that overwrite their address register.
function follows_a_chain
  ldr r0, =0x20002000
  ldr r1, =0x20002100
  str r1, [r0, #4]
  ldr r2, =0x60000000
  str r2, [r1, #8]
  ldr r0, [r0, #4]
  ldr r0, [r0, #8]
  here follows_a_chain
  ldr r0, [r0, #12]
  ldr r0, [r0, #16]
1:
  b 1b
end_function follows_a_chain

// All forms of loads and stores (ARMv7-M, A6.3 and A6.4). r0 to r3 are 0x60000000 and near it, r4 and r5 are RAM.
.macro form number, instruction:vararg
function form_\number
  movw r0, #0x100
  movt r0, #0x6000
  movw r1, #0x40
  movw r2, #0x80
  movt r2, #0x6000
  movw r4, #0x3000
  movt r4, #0x2000
  movw r5, #0x3100
  movt r5, #0x2000
  str r0, [r4]
  ldr r6, [r4]
  strh r1, [r5, #2]
  movs r3, #3
  here form_\number
  \instruction
  movs r7, #1
  str r7, [r4]
  ldr r7, [r5]
1:
  b 1b
end_function form_\number
.endm

  form 0, ldr r7, [r0]
  form 1, ldr r7, [r0, r1]
  form 2, ldr r7, [r0, #4]
  form 3, ldrh r7, [r0, #6]
  form 4, ldrb r7, [r0, #7]
  form 5, ldrsh r7, [r0, r1]
  form 6, ldrsb r7, [r0, r1]
  form 7, str r7, [r0]
  form 8, str r7, [r0, r1]
  form 9, strh r7, [r0, r1]
  form 10, strb r7, [r0, r1]
  form 11, strh r7, [r0, #8]
  form 12, strb r7, [r0, #9]
  form 13, stmia r0!, {r1, r2, r4}
  form 14, ldmia r0!, {r1, r2, r4}
  form 15, ldr.w r7, [r0, #1024]
  form 16, ldr.w r7, [r0, #-16]
  form 17, ldr.w r7, [r0, #16]!
  form 18, ldr.w r7, [r0], #16
  form 19, ldr.w r7, [r0, r1, lsl #2]
  form 20, str.w r7, [r0, #1024]
  form 21, str.w r7, [r0, #-16]
  form 22, str.w r7, [r0, #-16]!
  form 23, str.w r7, [r0], #-16
  form 24, str.w r7, [r0, r1, lsl #3]
  form 25, ldrb.w r7, [r0, #100]
  form 26, ldrsb.w r7, [r0, #100]
  form 27, ldrh.w r7, [r0, #100]
  form 28, ldrsh.w r7, [r0, #100]
  form 29, strb.w r7, [r0, #-100]
  form 30, strh.w r7, [r0, #-100]
  form 31, ldrd r6, r7, [r0, #8]
  form 32, ldrd r6, r7, [r0, #-8]!
  form 33, strd r6, r7, [r0], #8
  form 34, ldrex r7, [r0, #4]
  form 35, ldrexb r7, [r0]
  form 36, ldrexh r7, [r0]
  form 37, tbb [r0, r3]
  form 38, tbh [r0, r3, lsl #1]
  form 39, ldmdb r0, {r6, r7}
  form 40, stmdb r0!, {r6, r7}
  form 41, stmia.w r0, {r6-r9}
  form 42, ldr.w pc, [r0, r3, lsl #2]
  form 43, ldrt r7, [r0, #4]
  form 44, strbt r7, [r0, #4]
  .set form_count, 45
  .global form_count
