// Exceptions against the ARMv7-M Architecture Reference Manual (DDI 0403), B1.5.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim/mcu/cpu/cpu_rig.hpp"

namespace proleg::sim {
namespace {

using Marks = std::vector<std::uint32_t>;

constexpr std::uint32_t entry_mark = 0x1000;
constexpr std::uint32_t exit_mark = 0x2000;
constexpr std::uint32_t thread_end = exit_mark;

/// Exception number of an interrupt.
constexpr unsigned irq(unsigned interrupt) { return 16 + interrupt; }
constexpr std::uint32_t entry(unsigned exception) { return entry_mark + exception; }
constexpr std::uint32_t exit_of(unsigned exception) { return exit_mark + exception; }

class ExceptionFrame : public Programs {
 protected:
  static constexpr unsigned interrupt = 3;

  /// Runs the program into its loop, enables the interrupt and raises it.
  void interrupt_program(std::string_view program, std::string_view handler = "reporting_handler") {
    set_vector(irq(interrupt), handler);
    // NVIC registers cannot be reached from outside: a script enables the interrupt and then goes to the program.
    script(0, {step::store(scs::iser, 1U << interrupt), step::call(address_of(program) | 1U)});
    start("reset_handler");
    while (cpu_.core_register(15) != address_of("distinct_registers_loop")) {
      ASSERT_EQ(cpu_.run(1), Cpu::State::running);
    }
    for (unsigned i = 0; i <= 16; ++i) {
      before_[i] = cpu_.core_register(i);
    }
    cpu_.set_interrupt(interrupt, true);
    cpu_.set_interrupt(interrupt, false);
  }

  /// Enters the handler, and stops there.
  void enter() {
    cpu_.set_breakpoints(std::array{address_of("reporting_handler")});
    ASSERT_EQ(cpu_.run(100), Cpu::State::at_breakpoint);
    cpu_.set_breakpoints({});
  }

  void return_to_loop() {
    for (int i = 0; i < 100 && cpu_.active_exception() != 0; ++i) {
      ASSERT_EQ(cpu_.run(1), Cpu::State::running);
    }
  }

  /// r0-r3, r12, lr, pc, xPSR.
  [[nodiscard]] std::vector<std::uint32_t> frame(std::uint32_t address) const {
    std::vector<std::uint32_t> words;
    for (unsigned i = 0; i < 8; ++i) {
      words.push_back(rig_.word(address + 4 * i));
    }
    return words;
  }

  void expect_frame(std::uint32_t address, bool aligned) {
    const std::vector<std::uint32_t> expected{
        before_[0],  before_[1],  before_[2],  before_[3],
        before_[12], before_[14], before_[15], before_[16] | (aligned ? 1U << 9U : 0U)};
    EXPECT_EQ(frame(address), expected);
    EXPECT_EQ(before_[16], 0xA90F'0000U);
  }

  void expect_registers_as_before() {
    for (unsigned i = 0; i <= 16; ++i) {
      EXPECT_EQ(cpu_.core_register(i), before_[i]) << "register " << i;
    }
  }

  std::array<std::uint32_t, 17> before_{};
};

TEST_F(ExceptionFrame, EntryFromThreadModePushesEightWordsOnTheMainStack) {
  interrupt_program("distinct_registers");
  enter();
  const std::uint32_t sp = cpu_.core_register(13);
  const std::uint32_t below = before_[13] - 32;
  EXPECT_EQ(sp, below & ~7U);
  expect_frame(sp, (below & 4U) != 0);
  EXPECT_EQ(cpu_.core_register(14), 0xFFFF'FFF9U);
  EXPECT_EQ(cpu_.active_exception(), irq(interrupt));
  EXPECT_EQ(cpu_.core_register(16) & 0x0100'01FFU, 0x0100'0000U + irq(interrupt));
  for (unsigned i = 4; i <= 11; ++i) {
    EXPECT_EQ(cpu_.core_register(i), before_[i]);
  }
}

TEST_F(ExceptionFrame, ReturnRestoresEveryRegisterAndTheFlags) {
  interrupt_program("distinct_registers");
  return_to_loop();
  expect_registers_as_before();
}

TEST_F(ExceptionFrame, ReturnByPopOrLoadMultipleWorksAsByBx) {
  for (const char* handler : {"popping_handler", "ldm_handler"}) {
    interrupt_program("distinct_registers", handler);
    static_cast<void>(cpu_.run(1));
    return_to_loop();
    expect_registers_as_before();
  }
}

TEST_F(ExceptionFrame, AStackThatIsNotAlignedIsAlignedAndRestored) {
  std::vector<std::uint32_t> remainders;
  for (const char* program : {"distinct_registers", "distinct_registers_on_odd_stack"}) {
    interrupt_program(program);
    remainders.push_back(before_[13] % 8);
    enter();
    EXPECT_EQ(cpu_.core_register(13), (before_[13] - 32) & ~7U);
    expect_frame(cpu_.core_register(13), before_[13] % 8 != 0);
    return_to_loop();
    expect_registers_as_before();
  }
  std::sort(remainders.begin(), remainders.end());
  EXPECT_EQ(remainders, (std::vector<std::uint32_t>{0, 4}));
}

TEST_F(ExceptionFrame, EntryFromTheProcessStackPushesThereAndRunsOnTheMainStack) {
  for (const char* program : {"distinct_registers_on_process_stack", "distinct_registers_unprivileged"}) {
    const bool unprivileged = std::string_view(program) == "distinct_registers_unprivileged";
    interrupt_program(program);
    EXPECT_EQ(before_[13], 0x2000'8000U);
    enter();
    EXPECT_EQ(cpu_.core_register(14), 0xFFFF'FFFDU);
    expect_frame(0x2000'8000 - 32, false);
    const std::uint32_t main_stack = cpu_.core_register(13);
    EXPECT_GT(main_stack, initial_stack - 0x100);
    EXPECT_LE(main_stack, initial_stack);
    return_to_loop();
    expect_registers_as_before();
    // LR, MSP, PSP, xPSR, CONTROL as the handler saw them: on the main stack, nPRIV kept.
    EXPECT_EQ(rig_.take_marks(), Marks({0xFFFF'FFFD, main_stack, 0x2000'8000 - 32,
                                        0xA90F'0000U + irq(interrupt) - 0x0100'0000U, unprivileged ? 1U : 0U}));
    // A second one, so that CONTROL has been restored.
    cpu_.set_interrupt(interrupt, true);
    cpu_.set_interrupt(interrupt, false);
    enter();
    EXPECT_EQ(cpu_.core_register(14), 0xFFFF'FFFDU);
    return_to_loop();
    expect_registers_as_before();
    rig_.marks.clear();
  }
}

class ExceptionOrder : public Programs {
 protected:
  /// Priority of interrupts 0 to 3, 0 to 15 each.
  static step::Step priorities(unsigned first, unsigned second, unsigned third, unsigned fourth) {
    return step::store(scs::ipr, first << 4U | second << 12U | third << 20U | fourth << 28U);
  }
  static constexpr std::uint32_t all = 0xF;
};

TEST_F(ExceptionOrder, AnInterruptOfHigherPriorityPreemptsOneOfLower) {
  script(0, {priorities(2, 1, 3, 3), step::store(scs::iser, all), step::store(scs::ispr, 1U << 0U), step::mark(1)});
  script(irq(0), {step::store(scs::ispr, 1U << 1U), step::mark(2)});
  EXPECT_EQ(run_script(), Marks({entry(16), entry(17), exit_of(17), 2, exit_of(16), 1, thread_end}));
}

TEST_F(ExceptionOrder, AnInterruptOfTheSamePriorityWaits) {
  script(0, {priorities(1, 1, 1, 1), step::store(scs::iser, all), step::store(scs::ispr, 1U << 1U), step::mark(1)});
  script(irq(1), {step::store(scs::ispr, 1U << 0U), step::mark(2)});
  EXPECT_EQ(run_script(), Marks({entry(17), 2, exit_of(17), entry(16), exit_of(16), 1, thread_end}));
}

TEST_F(ExceptionOrder, TheHighestPriorityOfSeveralPendingComesFirstThenTheLowestNumber) {
  script(0, {priorities(5, 4, 4, 3), step::store(scs::iser, all), step::primask(1), step::store(scs::ispr, all),
             step::mark(1), step::primask(0), step::mark(2)});
  EXPECT_EQ(run_script(), Marks({1, entry(19), exit_of(19), entry(17), exit_of(17), entry(18), exit_of(18), entry(16),
                                 exit_of(16), 2, thread_end}));
}

TEST_F(ExceptionOrder, NestsAsDeepAsThereArePriorities) {
  script(0, {priorities(3, 2, 1, 0), step::store(scs::iser, all), step::store(scs::ispr, 1)});
  script(irq(0), {step::store(scs::ispr, 2)});
  script(irq(1), {step::store(scs::ispr, 4)});
  script(irq(2), {step::store(scs::ispr, 8)});
  script(irq(3), {step::mark_load(scs::iabr)});
  EXPECT_EQ(run_script(), Marks({entry(16), entry(17), entry(18), entry(19), 0xF, exit_of(19), exit_of(18), exit_of(17),
                                 exit_of(16), thread_end}));
}

TEST_F(ExceptionOrder, TheGroupOfAPriorityDecidesOnPreemptionTheRestOnTheOrder) {
  // PRIGROUP 5: bits 7 and 6 preempt (DDI 0403, B1.5.4).
  const step::Step group = step::store(scs::aircr, 0x05FA'0500);
  script(0, {group, priorities(6, 5, 4, 3), step::store(scs::iser, all), step::store(scs::ispr, 1)});
  script(irq(0), {step::store(scs::ispr, 2 + 4), step::mark(1), step::store(scs::ispr, 8), step::mark(2)});
  EXPECT_EQ(run_script(), Marks({entry(16), 1, entry(19), exit_of(19), 2, exit_of(16), entry(18), exit_of(18),
                                 entry(17), exit_of(17), thread_end}));
}

TEST_F(ExceptionOrder, TailChainingEntersTheNextWithoutGoingBack) {
  set_vector(irq(1), "register_handler");
  set_vector(irq(0), "reporting_handler");
  script(0, {priorities(1, 2, 0, 0), step::store(scs::iser, all), step::primask(1), step::store(scs::ispr, 3),
             step::primask(0)});
  // The second finds what the first left in the registers, which the hardware neither saves nor restores in between.
  const Marks marks = run_script();
  ASSERT_EQ(marks.size(), 5U + 4U + 1U);
  EXPECT_EQ(marks[0], 0xFFFF'FFF9U);
  EXPECT_EQ(Marks(marks.begin() + 5, marks.end()), Marks({0, 0, 0, 0, thread_end}));
}

TEST_F(ExceptionOrder, PrimaskHoldsBackEverythingUntilItIsCleared) {
  script(0, {step::store(scs::iser, all), step::primask(1), step::store(scs::ispr, 1), step::spin(10), step::mark(1),
             step::primask(0), step::mark(2)});
  EXPECT_EQ(run_script(), Marks({1, entry(16), exit_of(16), 2, thread_end}));
}

TEST_F(ExceptionOrder, FaultmaskHoldsBackEverythingAndIsClearedByTheReturnOfAHandler) {
  script(0, {step::store(scs::iser, all), step::store(scs::ispr, 1), step::mark(1), step::faultmask(1),
             step::store(scs::ispr, 2), step::mark(2), step::faultmask(0), step::mark(3)});
  script(irq(0), {step::faultmask(1), step::store(scs::ispr, 4)});
  EXPECT_EQ(run_script(),
            Marks({entry(16), exit_of(16), entry(18), exit_of(18), 1, 2, entry(17), exit_of(17), 3, thread_end}));
}

TEST_F(ExceptionOrder, BasepriHoldsBackItsPriorityAndBelow) {
  script(0, {priorities(6, 5, 4, 0), step::store(scs::iser, all), step::basepri(0x50), step::store(scs::ispr, 7),
             step::mark(1), step::basepri(0), step::mark(2)});
  EXPECT_EQ(run_script(),
            Marks({entry(18), exit_of(18), 1, entry(17), exit_of(17), entry(16), exit_of(16), 2, thread_end}));
}

TEST_F(ExceptionOrder, PrioritiesHaveFourBits) {
  script(0, {step::store(scs::ipr, 0x1F2F'0F01), step::mark_load(scs::ipr), step::store(scs::shpr3, 0xFFFF'FFFF),
             step::mark_load(scs::shpr3), step::basepri(0x0F), step::store(scs::iser, 1), step::store(scs::ispr, 1)});
  EXPECT_EQ(run_script(), Marks({0x1020'0000, 0xF0F0'00F0, entry(16), exit_of(16), thread_end}));
}

TEST_F(ExceptionOrder, PendSvAfterAnInterruptIsTakenLast) {
  script(0,
         {step::store(scs::shpr3, 0x00F0'0000), step::store(scs::iser, all), step::store(scs::ispr, 1), step::mark(1)});
  script(irq(0), {step::store(scs::icsr, 1U << 28U), step::mark_load(scs::icsr), step::store(scs::ispr, 2)});
  // ICSR: PENDSVSET, VECTPENDING 14, RETTOBASE, VECTACTIVE 16.
  EXPECT_EQ(run_script(), Marks({entry(16), 0x1000'E810, exit_of(16), entry(17), exit_of(17), entry(14), exit_of(14), 1,
                                 thread_end}));
}

TEST_F(ExceptionOrder, PendingIsClearedByIcprAndByEntry) {
  script(0, {step::primask(1), step::store(scs::iser, all), step::store(scs::ispr, 3), step::mark_load(scs::ispr),
             step::store(scs::icpr, 1), step::mark_load(scs::icpr), step::primask(0), step::mark_load(scs::ispr)});
  EXPECT_EQ(run_script(), Marks({3, 2, entry(17), exit_of(17), 0, thread_end}));
}

TEST_F(ExceptionOrder, EnablingAndDisabling) {
  script(0, {step::store(scs::ispr, 1), step::mark(1), step::store(scs::iser, 5), step::mark_load(scs::iser),
             step::store(scs::icer, 1), step::mark_load(scs::icer), step::store(scs::ispr, 1), step::mark(2)});
  EXPECT_EQ(run_script(), Marks({1, entry(16), exit_of(16), 5, 4, 2, thread_end}));
}

TEST_F(ExceptionOrder, StirPendsAnInterrupt) {
  script(0, {step::store(scs::iser + 8, 1U << 17U), step::store(scs::stir, 81), step::mark(1)});
  EXPECT_EQ(run_script(), Marks({entry(16 + 81), exit_of(16 + 81), 1, thread_end}));
}

TEST_F(ExceptionOrder, ALineThatStaysHighInterruptsAgainAndOneThatFallsDoesNot) {
  script(0, {step::store(scs::iser, all), step::store(0x4000'0010, 1), step::mark(1)});
  int rounds = 0;
  rig_.on_store = [&](const CpuRig::Store& store) {
    if (store.address == 0x4000'0010) {
      cpu_.set_interrupt(2, true);
    } else if (store.value == exit_of(18) && ++rounds == 3) {
      cpu_.set_interrupt(2, false);
    }
  };
  EXPECT_EQ(run_script(),
            Marks({entry(18), exit_of(18), entry(18), exit_of(18), entry(18), exit_of(18), 1, thread_end}));
}

TEST_F(ExceptionOrder, APulseThatComesWhileItsHandlerRunsIsNotLost) {
  script(0, {step::store(scs::iser, all), step::store(scs::ispr, 1), step::mark(1)});
  bool first = true;
  rig_.on_store = [&](const CpuRig::Store& store) {
    if (store.value == entry(16) && std::exchange(first, false)) {
      cpu_.set_interrupt(0, true);
      cpu_.set_interrupt(0, false);
    }
  };
  EXPECT_EQ(run_script(), Marks({entry(16), exit_of(16), entry(16), exit_of(16), 1, thread_end}));
}

TEST_F(ExceptionOrder, SupervisorCallPassesArgumentsAndResultThroughTheFrame) {
  set_vector(11, "supervisor");
  start("calls_supervisor");
  rig_.run(1000);
  EXPECT_EQ(rig_.marks, Marks({42, 3}));
}

TEST_F(ExceptionOrder, SupervisorCallWhereItsPriorityDoesNotAllowItIsAHardFault) {
  script(0, {step::primask(1), step::supervisor_call(), step::mark(1)});
  script(3, {step::mark_load(scs::hfsr)});
  EXPECT_EQ(run_script(), Marks({entry(3), 1U << 30U, exit_of(3), 1, thread_end}));
  const std::vector<CpuFault> faults = cpu_.take_faults();
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].cause, "SVC where its priority does not allow it");
}

TEST_F(ExceptionOrder, VtorMovesTheVectorTableAlsoIntoRam) {
  for (const std::uint32_t table : {0x0802'0000U, 0x2000'4000U}) {
    for (unsigned i = 0; i < 98; ++i) {
      rig_.set_word(table + 4 * i, rig_.word(ChipMemory::flash_start + 4 * i));
    }
    rig_.set_word(table + 4 * irq(0), address_of("short_handler") | 1U);
    script(0, {step::store(scs::iser, all), step::store(scs::ispr, 1), step::mark(1), step::store(scs::vtor, table),
               step::mark_load(scs::vtor), step::store(scs::ispr, 1), step::store(scs::ispr, 2)});
    EXPECT_EQ(run_script(), Marks({entry(16), exit_of(16), 1, table, entry(17), exit_of(17), thread_end}));
  }
}

TEST_F(ExceptionOrder, ResetRequestNeedsItsKeyAndEndsTheRun) {
  script(0, {step::store(scs::aircr, 4), step::mark(1), step::store(scs::aircr, 0x05FA'0004), step::mark(2)});
  start("reset_handler");
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::paused);
  EXPECT_EQ(rig_.resets, 1);
  EXPECT_EQ(rig_.take_marks(), Marks({1}));
  // RAM survives; the registers do not.
  cpu_.set_core_register(4, 0x1234);
  script(0, {step::mark_load(scs::vtor)});
  EXPECT_EQ(run_script(), Marks({0, thread_end}));
}

TEST_F(ExceptionOrder, ResetClearsWhatWasPendingEnabledAndActive) {
  script(0, {step::store(scs::iser, all), step::store(scs::ispr, 1)});
  script(irq(0), {step::store(scs::aircr, 0x05FA'0004), step::spin(1000)});
  start("reset_handler");
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::paused);
  EXPECT_EQ(cpu_.active_exception(), 16U);
  rig_.marks.clear();
  script(0, {step::mark_load(scs::iser), step::mark_load(scs::ispr), step::mark_load(scs::iabr), step::mark_control()});
  EXPECT_EQ(run_script(), Marks({0, 0, 0, 0, thread_end}));
}

TEST_F(ExceptionOrder, FixedRegistersHaveTheValuesOfTheChip) {
  script(0, {step::mark_load(0xE000'ED00), step::mark_load(0xE000'E004), step::mark_load(0xE000'ED90),
             step::mark_load(0xE000'E01C), step::mark_load(scs::ccr), step::mark_load(scs::aircr)});
  EXPECT_EQ(run_script(), Marks({0x410F'C241, 2, 0x800, 18'750, 0x200, 0xFA05'0000, thread_end}));
}

TEST_F(ExceptionOrder, TheCycleCounterCountsInstructionsWhileItIsEnabled) {
  constexpr std::uint32_t ctrl = 0xE000'1000;
  constexpr std::uint32_t cyccnt = 0xE000'1004;
  constexpr std::uint32_t demcr = 0xE000'EDFC;
  script(0, {step::store(ctrl, 1), step::mark_load(cyccnt), step::store(demcr, 1U << 24U), step::store(cyccnt, 0),
             step::mark_load(cyccnt), step::spin(1000), step::mark_load(cyccnt), step::store(ctrl, 0),
             step::mark_load(cyccnt), step::spin(100), step::mark_load(cyccnt)});
  const Marks marks = run_script();
  ASSERT_EQ(marks.size(), 6U);
  EXPECT_EQ(marks[0], 0U);
  EXPECT_LT(marks[1], 50U);
  EXPECT_GT(marks[2], marks[1] + 3000);
  EXPECT_LT(marks[2], marks[1] + 6000);
  EXPECT_EQ(marks[3], marks[4]);
}

class SystemTickTest : public Programs {};

TEST_F(SystemTickTest, InterruptsEveryReloadPlusOneClocks) {
  script(0, {step::store(scs::syst_rvr, 999), step::store(scs::syst_cvr, 0), step::store(scs::syst_csr, 7),
             step::spin(100'000)});
  std::vector<LocalTime> following;
  rig_.on_store = [&](const CpuRig::Store& store) {
    if (store.value == entry(15)) {
      following.push_back(cpu_.next_system_tick());
      // Entered with the first block after the tick.
      EXPECT_LT(following.back() - rig_.now(), 1000 * CpuRig::period);
      EXPECT_GT(following.back() - rig_.now(), 950 * CpuRig::period);
    }
  };
  start("reset_handler");
  rig_.run(50'000);
  ASSERT_GE(following.size(), 45U);
  for (std::size_t i = 1; i < following.size(); ++i) {
    EXPECT_EQ(following[i] - following[i - 1], 1000 * CpuRig::period);
  }
}

TEST_F(SystemTickTest, CountsDownAndItsCountFlagReadsOneOnce) {
  script(0, {step::store(scs::syst_rvr, 100'000), step::store(scs::syst_cvr, 7), step::store(scs::syst_csr, 5),
             step::mark_load(scs::syst_cvr), step::spin(1000), step::mark_load(scs::syst_cvr),
             step::mark_load(scs::syst_csr), step::spin(40'000), step::mark_load(scs::syst_csr),
             step::mark_load(scs::syst_csr), step::mark_load(scs::syst_cvr)});
  const Marks marks = run_script(1'000'000);
  ASSERT_EQ(marks.size(), 7U);
  EXPECT_GT(marks[0], 99'950U);
  EXPECT_LE(marks[0], 100'000U);
  EXPECT_LT(marks[1], marks[0] - 3000);
  EXPECT_EQ(marks[2], 5U);
  EXPECT_EQ(marks[3], 0x1'0005U);
  EXPECT_EQ(marks[4], 5U);
  EXPECT_LE(marks[5], 100'000U);
}

TEST_F(SystemTickTest, TheOtherClockIsAnEighth) {
  script(0, {step::store(scs::syst_rvr, 1000), step::store(scs::syst_cvr, 0), step::store(scs::syst_csr, 3)});
  start("reset_handler");
  rig_.run(200);
  const LocalTime first = cpu_.next_system_tick();
  rig_.run(20'000);
  EXPECT_EQ((cpu_.next_system_tick() - first) % (8 * 1001 * CpuRig::period), 0U);
  EXPECT_GT(cpu_.next_system_tick(), first);
}

TEST_F(SystemTickTest, AnotherCoreClockCountsOnFromTheSameValue) {
  script(0, {step::store(scs::syst_rvr, 10'000), step::store(scs::syst_cvr, 0), step::store(scs::syst_csr, 7)});
  start("reset_handler");
  rig_.run(200);
  const LocalTime now = rig_.now();
  const LocalTime left = cpu_.next_system_tick() - now;
  rig_.core = CpuRig::period / 3;
  rig_.slept = now - cpu_.instructions() * rig_.core;
  cpu_.change_core_period();
  EXPECT_EQ(cpu_.next_system_tick() - now, left / 3);
}

TEST_F(SystemTickTest, WakesFromSleep) {
  script(0, {step::store(scs::syst_rvr, 15'999), step::store(scs::syst_cvr, 0), step::store(scs::syst_csr, 7),
             step::wait_for_interrupt(), step::mark(1), step::wait_for_interrupt(), step::mark(2)});
  start("reset_handler");
  while (cpu_.run(10'000) == Cpu::State::running) {
  }
  EXPECT_EQ(cpu_.state(), Cpu::State::sleeping);
  EXPECT_FALSE(cpu_.wakes());
  rig_.slept += cpu_.next_system_tick() - rig_.now();
  cpu_.advance_system_tick();
  EXPECT_TRUE(cpu_.wakes());
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::sleeping);
  EXPECT_EQ(rig_.marks, Marks({entry(15), exit_of(15), 1}));
}

/// All that a program can read of its state.
struct EndState {
  std::vector<std::uint32_t> marks;
  std::vector<std::uint32_t> registers;
  std::vector<std::uint8_t> ram;
  std::uint64_t instructions = 0;
  LocalTime time = 0;
  bool operator==(const EndState&) const = default;
};

class Slices : public Programs {
 protected:
  EndState run_in_slices(std::uint64_t slice) {
    script(0, {step::store(scs::syst_rvr, 1234), step::store(scs::syst_cvr, 0), step::store(scs::syst_csr, 7),
               step::store(scs::iser, 0xF), step::store(scs::ipr, 0x1020'3040), step::store(scs::shpr3, 0xF0F0'0000),
               step::spin(500), step::store(scs::ispr, 1), step::wait_for_interrupt(), step::spin(500),
               step::mark_load(scs::syst_cvr)});
    script(15, {step::store(scs::icsr, 1U << 28U), step::store(scs::ispr, 2)});
    script(14, {step::spin(30), step::store(scs::ispr, 4), step::mark_load(scs::syst_cvr)});
    script(irq(2), {step::spin(100)});
    start("reset_handler");
    rig_.run(100'000, slice);
    EndState end;
    end.marks = rig_.marks;
    for (unsigned i = 0; i <= 16; ++i) {
      end.registers.push_back(cpu_.core_register(i));
    }
    end.ram.resize(ChipMemory::ram_size);
    cpu_.read(ChipMemory::ram_start, end.ram);
    end.instructions = cpu_.instructions();
    end.time = rig_.now();
    return end;
  }
};

/// Each runs in its own CPU.
class SlicesOf : public Slices, public testing::WithParamInterface<std::uint64_t> {
 public:
  static inline EndState first;
};

TEST_P(SlicesOf, TheEndIsTheSameInWhateverSlicesItRuns) {
  const EndState end = run_in_slices(GetParam());
  EXPECT_GT(end.marks.size(), 200U);
  if (first.marks.empty()) {
    first = end;
  }
  EXPECT_EQ(end.marks, first.marks);
  EXPECT_EQ(end.registers, first.registers);
  EXPECT_EQ(end.ram, first.ram);
  EXPECT_EQ(end.instructions, first.instructions);
  EXPECT_EQ(end.time, first.time);
}

INSTANTIATE_TEST_SUITE_P(Sizes, SlicesOf, testing::Values(1, 7, 100, 5000, 5000));

}  // namespace
}  // namespace proleg::sim
