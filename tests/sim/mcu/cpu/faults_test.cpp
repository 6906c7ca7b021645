// What a program can do wrong (DDI 0403, B1.5.14).

#include <gtest/gtest.h>

#include <string>

#include "tests/sim/mcu/cpu/cpu_rig.hpp"

namespace proleg::sim {
namespace {

using Marks = std::vector<std::uint32_t>;

constexpr std::uint32_t forced = 1U << 30U;
constexpr unsigned pc = 15;

class Faults : public Programs {
 protected:
  Faults() { script(3, {step::mark_load(scs::hfsr), step::mark_load(scs::cfsr), step::mark_load(scs::bfar)}); }

  /// Runs a program into its fault, which it must note. Ends with the handler, whose return may repeat the fault.
  CpuFault fault_of(std::string_view program) {
    rig_.marks.clear();
    start(program);
    rig_.on_store = [&](const CpuRig::Store& store) {
      if (store.value >= 0x2000 && store.value < 0x2010) {
        cpu_.pause();
      }
    };
    rig_.run(10'000);
    const std::vector<CpuFault> faults = cpu_.take_faults();
    EXPECT_GE(faults.size(), 1U) << program;
    return faults.empty() ? CpuFault{"none", std::vector<std::uint32_t>(17), false} : faults[0];
  }

  static std::uint32_t here(const std::string& program) { return address_of(program + "_here"); }
};

TEST_F(Faults, ALoadWithoutMemoryIsABusFaultThatBecomesAHardFault) {
  const CpuFault fault = fault_of("faults_between_stores");
  EXPECT_EQ(fault.cause, "load from 0x60000000, where there is no memory");
  EXPECT_EQ(fault.registers[pc], here("faults_between_stores"));
  EXPECT_EQ(fault.registers[2], 2U);
  EXPECT_FALSE(fault.locked_up);
  // The stores before it, once each; then HFSR.FORCED, CFSR.PRECISERR and BFARVALID, BFAR.
  EXPECT_EQ(rig_.marks, Marks({1, 2, 0x1003, forced, 0x8200, 0x6000'0000, 0x2003}));
}

TEST_F(Faults, TheFrameOfAFaultPointsToTheInstructionThatDidIt) {
  static_cast<void>(fault_of("faults_between_stores"));
  // Main stack: frame of the fault.
  EXPECT_EQ(rig_.word(initial_stack - 32 + 24), here("faults_between_stores"));
}

TEST_F(Faults, AHandlerMaySkipTheInstructionAndTheProgramContinues) {
  set_vector(3, "skipping_handler");
  start("faults_between_stores");
  rig_.run(10'000);
  EXPECT_EQ(rig_.marks, Marks({1, 2, 3}));
  EXPECT_EQ(cpu_.state(), Cpu::State::sleeping);
}

TEST_F(Faults, OnlyTheInstructionsBeforeAFaultCount) {
  set_vector(3, "skipping_handler");
  start("faults_between_stores");
  rig_.run(10'000);
  // 6 before it (two loads of constants among them), 4 of the handler, 3 behind.
  EXPECT_EQ(cpu_.instructions(), 6U + 4U + 3U);
}

TEST_F(Faults, EveryFormOfLoadAndStoreIsFoundInItsBlock) {
  constexpr int forms = 45;
  for (int i = 0; i < forms; ++i) {
    const std::string program = "form_" + std::to_string(i);
    const CpuFault fault = fault_of(program);
    EXPECT_EQ(fault.registers[pc], here(program)) << program << ": " << fault.cause;
  }
}

TEST_F(Faults, InAChainOfLoadsTheOneThatFailedIsNamed) {
  const CpuFault fault = fault_of("follows_a_chain");
  EXPECT_EQ(fault.cause, "load from 0x6000000C, where there is no memory");
  EXPECT_EQ(fault.registers[pc], here("follows_a_chain"));
}

TEST_F(Faults, AnUndefinedInstruction) {
  const CpuFault fault = fault_of("undefined_instruction");
  EXPECT_EQ(fault.cause, "undefined instruction");
  EXPECT_EQ(fault.registers[pc], here("undefined_instruction"));
  EXPECT_EQ(Marks(rig_.marks.begin(), rig_.marks.begin() + 4), Marks({1, 0x1003, forced, 1U << 16U}));
}

TEST_F(Faults, AJumpToAnInvalidAddress) {
  const CpuFault fault = fault_of("bad_jump");
  EXPECT_EQ(fault.cause, "execution at 0x60000000, where there is no memory");
  EXPECT_EQ(fault.registers[pc], 0x6000'0000U);
  EXPECT_EQ(Marks(rig_.marks.begin(), rig_.marks.begin() + 3), Marks({0x1003, forced, 1U << 8U}));
}

TEST_F(Faults, ACallOfANullPointer) {
  const CpuFault null = fault_of("null_call");
  EXPECT_EQ(null.cause, "a branch to an even address, which is not Thumb code");
  EXPECT_EQ(null.registers[pc], 0U);
  EXPECT_EQ(null.registers[14], (address_of("null_call") + 4) | 1U);
  const CpuFault odd = fault_of("null_call_in_thumb_state");
  EXPECT_EQ(odd.cause, "execution at 0x0, where there is no memory");
  EXPECT_EQ(odd.registers[pc], 0U);
}

TEST_F(Faults, AJumpToWhereNothingMayBeExecuted) {
  const CpuFault peripheral = fault_of("jump_to_peripheral");
  EXPECT_EQ(peripheral.cause, "execution at 0x40000000, where execution is not possible");
  EXPECT_EQ(rig_.marks[2], 1U);  // IACCVIOL
  const CpuFault ccm = fault_of("jump_to_ccm");
  EXPECT_EQ(ccm.cause, "execution at 0x10000000, where execution is not possible");
  EXPECT_EQ(rig_.marks[2], 1U << 8U);
}

TEST_F(Faults, AJumpToAnEvenAddress) {
  const CpuFault fault = fault_of("jump_to_even");
  EXPECT_EQ(fault.cause, "a branch to an even address, which is not Thumb code");
  EXPECT_EQ(fault.registers[pc], address_of("short_handler"));
  EXPECT_EQ(rig_.marks[2], 1U << 17U);
}

TEST_F(Faults, AnExceptionReturnInThreadModeIsAJumpToAnInvalidAddress) {
  const CpuFault fault = fault_of("false_return");
  EXPECT_EQ(fault.cause, "execution at 0xFFFFFFF8, where execution is not possible");
}

TEST_F(Faults, AnUnalignedExclusiveAccess) {
  const CpuFault fault = fault_of("unaligned_exclusive");
  EXPECT_EQ(fault.cause, "access of 4 bytes at 0x20001002, which is not aligned");
  EXPECT_EQ(fault.registers[pc], here("unaligned_exclusive"));
  EXPECT_EQ(rig_.marks[2], 1U << 24U);
}

TEST_F(Faults, ABreakpointInstructionWithoutDebugger) {
  const CpuFault fault = fault_of("breaks");
  EXPECT_EQ(fault.cause, "BKPT without a debugger");
  EXPECT_EQ(fault.registers[pc], here("breaks"));
  EXPECT_EQ(rig_.marks[1], 1U << 31U);
}

TEST_F(Faults, TheFpuWhileItIsForbidden) {
  const CpuFault fault = fault_of("uses_fpu");
  EXPECT_EQ(fault.cause, "FPU or coprocessor instruction while CPACR forbids it");
  EXPECT_EQ(fault.registers[pc], here("uses_fpu"));
  EXPECT_EQ(Marks(rig_.marks.begin(), rig_.marks.begin() + 4), Marks({1, 0x1003, forced, 1U << 19U}));
}

TEST_F(Faults, TheFpuIsNotModelledWhenItIsAllowed) {
  start("allows_and_uses_fpu");
  rig_.run(10'000);
  EXPECT_EQ(cpu_.state(), Cpu::State::halted);
  EXPECT_TRUE(cpu_.halt_reason().starts_with("an instruction of the FPU, which is not modelled, at 0x"))
      << cpu_.halt_reason();
  EXPECT_EQ(rig_.marks, Marks());
}

TEST_F(Faults, AStoreThatTheFlashRejects) {
  const CpuFault fault = fault_of("stores_to_flash");
  EXPECT_EQ(fault.cause, "store to 0x8040000, where a store is not possible now");
  EXPECT_EQ(Marks(rig_.marks.begin(), rig_.marks.begin() + 4), Marks({1, 0x1003, forced, 0x8200}));
}

TEST_F(Faults, HaveTheirOwnHandlersIfEnabledInShcsr) {
  const auto enable = step::store(scs::shcsr, 7U << 16U);
  script(5, {step::mark_load(scs::bfar)});
  script(0, {enable, step::call(address_of("faults_between_stores") | 1U)});
  static_cast<void>(fault_of("reset_handler"));
  EXPECT_EQ(rig_.marks, Marks({1, 2, 0x1005, 0x6000'0000, 0x2005}));
  script(6, {step::mark_load(scs::cfsr)});
  script(0, {enable, step::call(address_of("undefined_instruction") | 1U)});
  static_cast<void>(fault_of("reset_handler"));
  EXPECT_EQ(rig_.marks, Marks({1, 0x1006, 1U << 16U, 0x2006}));
  script(4, {step::mark_load(scs::cfsr)});
  script(0, {enable, step::call(address_of("jump_to_peripheral") | 1U)});
  static_cast<void>(fault_of("reset_handler"));
  EXPECT_EQ(rig_.marks, Marks({0x1004, 1, 0x2004}));
}

TEST_F(Faults, AnEnabledFaultHandlerOfTooLowPriorityGivesAHardFault) {
  script(0, {step::store(scs::shcsr, 7U << 16U), step::store(scs::shpr1, 0x00F0'F0F0), step::basepri(0x80),
             step::call(address_of("undefined_instruction") | 1U)});
  static_cast<void>(fault_of("reset_handler"));
  EXPECT_EQ(Marks(rig_.marks.begin(), rig_.marks.begin() + 3), Marks({1, 0x1003, forced}));
}

TEST_F(Faults, FaultStatusIsClearedByWritingOnes) {
  script(3, {step::store(scs::cfsr, 0xFFFF'FFFF), step::mark_load(scs::cfsr), step::store(scs::hfsr, 0xFFFF'FFFF),
             step::mark_load(scs::hfsr)});
  static_cast<void>(fault_of("faults_between_stores"));
  EXPECT_EQ(rig_.marks, Marks({1, 2, 0x1003, 0, 0, 0x2003}));
}

TEST_F(Faults, AFaultInTheHardFaultHandlerLocksUp) {
  set_vector(3, "faulting_handler");
  start("bad_jump");
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::locked_up);
  const std::vector<CpuFault> faults = cpu_.take_faults();
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_FALSE(faults[0].locked_up);
  EXPECT_TRUE(faults[1].locked_up);
  EXPECT_EQ(faults[1].cause, "undefined instruction");
  EXPECT_EQ(faults[1].registers[pc], here("faulting_handler"));
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::locked_up);
  EXPECT_EQ(rig_.resets, 0);
  start("counted_loop");
  EXPECT_EQ(cpu_.run(10), Cpu::State::running);
}

TEST_F(Faults, AFaultUnderFaultmaskLocksUp) {
  script(0, {step::faultmask(1), step::call(address_of("bad_jump") | 1U)});
  start("reset_handler");
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::locked_up);
}

/// Registers of the MPU (DDI 0403, B3.5): region 0 is the 4 KiB below the RAM, without access.
class GuardedStack : public Faults {
 protected:
  static constexpr std::uint32_t one_push = 32;

  void overflow(std::uint32_t control) {
    script(0, {step::store(0xE000'ED9C, 0x1FFF'F010), step::store(0xE000'EDA0, 0x1000'0017),
               step::store(0xE000'ED94, control), step::call(address_of("stack_overflow") | 1U)});
  }
};

TEST_F(GuardedStack, AnOverflowEndsWhereTheRamBegins) {
  overflow(5);  // PRIVDEFENA, ENABLE
  const CpuFault fault = fault_of("reset_handler");
  EXPECT_GE(fault.registers[13], ChipMemory::ram_start);
  EXPECT_LT(fault.registers[13], ChipMemory::ram_start + one_push);
  EXPECT_TRUE(fault.cause.starts_with("store to 0x1FFFFF") || fault.cause.starts_with("the stack at 0x1FFFFF"))
      << fault.cause;
}

TEST_F(GuardedStack, WithoutTheMpuAnOverflowGoesOnInReservedAddresses) {
  overflow(4);
  const CpuFault fault = fault_of("reset_handler");
  EXPECT_GE(fault.registers[13], ChipMemory::reserved_start);
  EXPECT_LT(fault.registers[13], ChipMemory::reserved_start + one_push);
}

TEST_F(GuardedStack, OtherRegionsAreNotModelled) {
  script(0,
         {step::store(0xE000'ED9C, 0x2000'0010), step::store(0xE000'EDA0, 0x1000'0017), step::store(0xE000'ED94, 5)});
  start("reset_handler");
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::halted);
  EXPECT_NE(cpu_.halt_reason().find("only regions of the MPU without access"), std::string::npos);
}

TEST_F(Faults, AnExceptionWithoutMemoryForItsStackIsAnotherFault) {
  script(0, {step::store(scs::iser, 1)});
  start("reset_handler");
  rig_.run(10'000);
  cpu_.set_core_register(13, 0x3000'0000);
  cpu_.set_interrupt(0, true);
  rig_.run(10'000);
  const std::vector<CpuFault> faults = cpu_.take_faults();
  ASSERT_GE(faults.size(), 1U);
  EXPECT_EQ(faults[0].cause, "the stack at 0x2FFFFFE0, where there is no memory, at the entry of exception 16");
  EXPECT_EQ(cpu_.state(), Cpu::State::locked_up);
}

TEST_F(Faults, AWrongExceptionReturnIsAUsageFault) {
  set_vector(16, "bad_exc_return");
  script(0, {step::store(scs::iser, 1), step::store(scs::ispr, 1)});
  const CpuFault fault = fault_of("reset_handler");
  EXPECT_EQ(fault.cause, "return from exception 16 by 0xFFFFFFF1");
  EXPECT_EQ(Marks(rig_.marks.begin(), rig_.marks.begin() + 3), Marks({0x1003, forced, 1U << 18U}));
}

TEST_F(Faults, AnErasedFlashLocksUpAtOnce) {
  CpuRig rig;
  rig.cpu.reset();
  EXPECT_EQ(rig.cpu.run(1000), Cpu::State::locked_up);
  EXPECT_FALSE(rig.cpu.take_faults().empty());
}

TEST_F(Faults, AResetVectorThatIsNotThumbIsAFault) {
  rig_.set_word(ChipMemory::flash_start + 4, address_of("counted_loop"));
  cpu_.reset();
  rig_.run(1000);
  const std::vector<CpuFault> faults = cpu_.take_faults();
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_TRUE(faults[0].cause.starts_with("the vector table sends the reset to 0x")) << faults[0].cause;
  EXPECT_EQ(rig_.marks[0], 0x1003U);
}

TEST_F(Faults, AVectorThatIsNotThumbIsAnotherFault) {
  rig_.set_word(ChipMemory::flash_start + 64, address_of("short_handler"));
  script(0, {step::store(scs::iser, 1), step::store(scs::ispr, 1)});
  const CpuFault fault = fault_of("reset_handler");
  EXPECT_TRUE(fault.cause.starts_with("the vector of exception 16 is 0x")) << fault.cause;
}

}  // namespace
}  // namespace proleg::sim
