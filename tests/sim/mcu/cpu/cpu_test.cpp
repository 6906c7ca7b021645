// Execution, memory and sleep.

#include "sim/mcu/cpu/cpu.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>

#include "shared/fixed/random.hpp"
#include "tests/sim/mcu/cpu/cpu_rig.hpp"

namespace proleg::sim {
namespace {

using Marks = std::vector<std::uint32_t>;

class CpuTest : public Programs {};

TEST_F(CpuTest, StartsWithStackPointerAndAddressOfTheVectorTable) {
  start("counted_loop");
  EXPECT_EQ(cpu_.core_register(13), initial_stack);
  EXPECT_EQ(cpu_.core_register(14), 0xFFFF'FFFFU);
  EXPECT_EQ(cpu_.core_register(15), address_of("counted_loop"));
  EXPECT_EQ(cpu_.core_register(16), 0x0100'0000U);
  EXPECT_EQ(cpu_.active_exception(), 0U);
}

TEST_F(CpuTest, CountsInstructionsOfTwoAndFourBytesExactly) {
  start("counted_loop");
  EXPECT_EQ(cpu_.run(10'000'000), Cpu::State::sleeping);
  EXPECT_EQ(cpu_.instructions(), 1'000'001U);
}

TEST_F(CpuTest, CountsALoopOfAnyLengthEachTimeItRuns) {
  constexpr std::uint32_t program = ChipMemory::flash_start + 0x1000;
  for (const std::uint32_t length : {2U, 253U, 254U, 255U, 256U, 257U, 400U}) {
    std::vector<std::uint8_t> code;
    const auto add = [&code](std::uint32_t instruction) {
      code.push_back(static_cast<std::uint8_t>(instruction));
      code.push_back(static_cast<std::uint8_t>(instruction >> 8U));
    };
    for (std::uint32_t i = 1; i < length; ++i) {
      add(0xBF00);  // nop
    }
    add(0xE000U | ((0U - (length + 1)) & 0x7FFU));  // b, to the first one
    CpuRig rig;
    rig.cpu.write(program, code);
    rig.set_word(ChipMemory::flash_start, initial_stack);
    rig.set_word(ChipMemory::flash_start + 4, program | 1U);
    rig.cpu.reset();
    constexpr unsigned rounds = 10;
    EXPECT_EQ(rig.cpu.run(rounds * length), Cpu::State::running);
    EXPECT_EQ(rig.cpu.instructions(), rounds * length) << length << " instructions";
  }
}

TEST_F(CpuTest, RunsForTheGivenNumberOfInstructions) {
  start("counted_loop");
  for (const std::uint64_t budget : {std::uint64_t{1}, std::uint64_t{7}, std::uint64_t{100}, std::uint64_t{5000}}) {
    const std::uint64_t before = cpu_.instructions();
    EXPECT_EQ(cpu_.run(budget), Cpu::State::running);
    EXPECT_EQ(cpu_.instructions() - before, budget);
  }
  EXPECT_EQ(cpu_.run(0), Cpu::State::running);
}

TEST_F(CpuTest, NewMemoryIsErasedFlashAndTheSameNoiseInEveryRam) {
  CpuRig other;
  std::vector<std::uint8_t> ram(ChipMemory::ram_size);
  std::vector<std::uint8_t> other_ram(ChipMemory::ram_size);
  CpuRig fresh;
  fresh.cpu.read(ChipMemory::ram_start, ram);
  other.cpu.read(ChipMemory::ram_start, other_ram);
  EXPECT_EQ(ram, other_ram);
  EXPECT_NE(ram, std::vector<std::uint8_t>(ChipMemory::ram_size, ram[0]));
  EXPECT_EQ(fresh.word(ChipMemory::flash_start), 0xFFFF'FFFFU);
  EXPECT_EQ(fresh.word(ChipMemory::flash_start + ChipMemory::flash_size - 4), 0xFFFF'FFFFU);
  EXPECT_THROW(static_cast<void>(fresh.word(ChipMemory::flash_start + ChipMemory::flash_size - 2)), std::out_of_range);
  EXPECT_THROW(static_cast<void>(fresh.word(0x4000'0000)), std::out_of_range);
  EXPECT_THROW(fresh.set_word(0, 1), std::out_of_range);
}

TEST_F(CpuTest, StoresToRegistersHappenExactlyOnceInSpiteOfInterrupts) {
  script(16 + 3, {});
  start("stores_once");
  rig_.run(1000);
  const std::vector<CpuRig::Store> expected{{0x4000'0000, 4, 1}, {0x4000'0000, 4, 0x1013}, {0x4000'0000, 4, 0x2013},
                                            {0x4000'0000, 4, 2}, {0x4000'0004, 2, 2},      {0x4000'0008, 1, 2},
                                            {0x4000'0000, 4, 3}};
  EXPECT_EQ(rig_.stores, expected);
}

TEST_F(CpuTest, PauseWithinAStoreEndsTheRunBehindIt) {
  start("stores_once");
  rig_.on_store = [&](const CpuRig::Store& store) {
    if (store.value == 1) {
      cpu_.pause();
    }
  };
  EXPECT_EQ(cpu_.run(1000), Cpu::State::paused);
  EXPECT_EQ(rig_.marks, Marks({1}));
  EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
  EXPECT_EQ(rig_.marks, Marks({1, 0x1013, 0x2013, 2, 3}));
}

TEST_F(CpuTest, LimitWithinAStoreEndsTheRunBehindIt) {
  start("stores_once");
  rig_.on_store = [&](const CpuRig::Store& store) {
    if (store.value == 1) {
      cpu_.limit(cpu_.instructions());
    }
  };
  EXPECT_EQ(cpu_.run(1000), Cpu::State::running);
  EXPECT_EQ(rig_.marks, Marks({1}));
}

TEST_F(CpuTest, HaltEndsTheRunUntilReset) {
  start("stores_once");
  rig_.on_store = [&](const CpuRig::Store& store) {
    if (store.value == 1) {
      cpu_.halt("the board is not modelled");
    }
  };
  EXPECT_EQ(cpu_.run(1000), Cpu::State::halted);
  EXPECT_TRUE(cpu_.halt_reason().starts_with("the board is not modelled, by the code at 0x")) << cpu_.halt_reason();
  EXPECT_EQ(cpu_.run(1000), Cpu::State::halted);
  rig_.on_store = [](const CpuRig::Store&) {};
  start("counted_loop");
  EXPECT_EQ(cpu_.halt_reason(), "");
  EXPECT_EQ(cpu_.run(10'000'000), Cpu::State::sleeping);
}

TEST_F(CpuTest, AnUnknownRegisterOfThePrivateBusHaltsWithItsUnitAndAddress) {
  script(0, {step::mark_load(0xE000'2000)});
  EXPECT_EQ(run_script(), Marks());
  EXPECT_EQ(cpu_.state(), Cpu::State::halted);
  EXPECT_TRUE(
      cpu_.halt_reason().starts_with("load from 0xE0002000 (private peripheral bus, FPB), which is not modelled"))
      << cpu_.halt_reason();
}

TEST_F(CpuTest, SleepsAtWfiAndContinuesBehindIt) {
  start("sleeps_masked");
  EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
  EXPECT_FALSE(cpu_.wakes());
  EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
  EXPECT_EQ(rig_.marks, Marks());
}

TEST_F(CpuTest, AMaskedInterruptWakesAndIsTakenWhenItIsUnmasked) {
  script(0, {step::store(scs::iser, 2), step::call(address_of("sleeps_masked") | 1U)});
  EXPECT_EQ(run_script(), Marks());
  EXPECT_EQ(cpu_.state(), Cpu::State::sleeping);
  cpu_.set_interrupt(1, true);
  EXPECT_TRUE(cpu_.wakes());
  rig_.on_store = [&](const CpuRig::Store& store) { cpu_.set_interrupt(1, store.value == 1); };
  rig_.run(1000);
  EXPECT_EQ(rig_.marks, Marks({1, 0x1011, 0x2011, 2}));
}

TEST_F(CpuTest, ADisabledInterruptDoesNotWake) {
  start("sleeps_masked");
  rig_.run(1000);
  cpu_.set_interrupt(1, true);
  EXPECT_FALSE(cpu_.wakes());
}

TEST_F(CpuTest, AnInterruptBelowBasepriDoesNotWake) {
  script(0, {step::store(scs::iser, 6), step::store(scs::ipr, 0x0020'5000), step::basepri(0x50),
             step::wait_for_interrupt(), step::mark(7)});
  EXPECT_EQ(run_script(), Marks());
  cpu_.set_interrupt(1, true);
  EXPECT_FALSE(cpu_.wakes());
  cpu_.set_interrupt(2, true);
  EXPECT_TRUE(cpu_.wakes());
}

TEST_F(CpuTest, WfiInAnItBlockSleepsOnlyIfItsConditionHolds) {
  script(16 + 1, {});
  start("sleeps_conditionally");
  EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
  EXPECT_EQ(rig_.marks, Marks({1}));
}

TEST_F(CpuTest, WfeSleepsWithoutAnEvent) {
  start("waits_for_events");
  EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
  EXPECT_EQ(rig_.marks, Marks());
}

TEST_F(CpuTest, WfeTakesAnEventThatWasSentBefore) {
  script(0, {step::send_event(), step::wait_for_event(), step::mark(1), step::wait_for_event(), step::mark(2)});
  EXPECT_EQ(run_script(), Marks({1}));
  EXPECT_EQ(cpu_.state(), Cpu::State::sleeping);
}

TEST_F(CpuTest, WfeWakesByAnInterruptWhoseEntryIsAnEvent) {
  script(0, {step::store(scs::iser, 2), step::wait_for_event(), step::mark(1), step::send_event(),
             step::wait_for_event(), step::mark(2), step::wait_for_event(), step::mark(3)});
  EXPECT_EQ(run_script(), Marks());
  EXPECT_EQ(cpu_.state(), Cpu::State::sleeping);
  rig_.on_store = [&](const CpuRig::Store&) { cpu_.set_interrupt(1, false); };
  cpu_.set_interrupt(1, true);
  EXPECT_TRUE(cpu_.wakes());
  rig_.run(1000);
  // The handler has run; its event ends the second WFE at once, and SEV merges with it.
  EXPECT_EQ(rig_.take_marks(), Marks({0x1011, 0x2011, 1, 2}));
  EXPECT_EQ(cpu_.state(), Cpu::State::sleeping);
}

TEST_F(CpuTest, YieldDoesNothing) {
  start("yields");
  EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
  EXPECT_EQ(rig_.marks, Marks({1, 2}));
}

TEST_F(CpuTest, SleepOnExitSleepsWithoutRunningThreadMode) {
  script(0, {step::store(scs::iser, 2), step::store(scs::scr, 2), step::wait_for_interrupt(), step::mark(5)});
  EXPECT_EQ(run_script(), Marks());
  rig_.on_store = [&](const CpuRig::Store&) { cpu_.set_interrupt(1, false); };
  for (int i = 0; i < 3; ++i) {
    cpu_.set_interrupt(1, true);
    EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
    EXPECT_EQ(rig_.take_marks(), Marks({0x1011, 0x2011}));
  }
}

/// A random program: sums, comparisons, jumps forward, IT blocks and words that are loaded from beside the code. It
/// ends in a loop of one instruction.
std::vector<std::uint8_t> random_program(Pcg32& random) {
  std::vector<std::uint8_t> code;
  const auto add = [&](std::uint32_t halfword) {
    code.push_back(static_cast<std::uint8_t>(halfword));
    code.push_back(static_cast<std::uint8_t>(halfword >> 8U));
  };
  const auto drawn_register = [&] { return random.below(6); };
  const auto add_sum = [&] {
    const std::uint32_t d = drawn_register();
    switch (random.below(4)) {
      case 0:
        return add(0x3000U | d << 8U | random.below(256));  // adds d, #
      case 1:
        return add(0x1800U | d << 6U | drawn_register() << 3U | drawn_register());  // adds
      case 2:
        return add(0x4040U | d << 3U | drawn_register());  // eors
      default:
        return add(0x0840U | d << 3U | drawn_register());  // lsrs #1
    }
  };
  const auto add_comparison = [&] {
    const std::uint32_t n = drawn_register();
    switch (random.below(6)) {
      case 0:
        return add(0x2800U | n << 8U | random.below(256));  // cmp n, #
      case 1:
        return add(0x4280U | n << 3U | drawn_register());  // cmp
      case 2:
        return add(0x3800U | n << 8U | random.below(4));  // subs n, #
      case 3:
        return add(0x4200U | n << 3U | drawn_register());  // tst
      case 4:
        add(0xF1B0U | n);  // cmp.w n, #
        return add(0x0F00U | random.below(256));
      default:
        add(0xF010U | n);  // tst.w n, #
        return add(0x0F00U | random.below(256));
    }
  };
  for (int i = 0; i < 500; ++i) {
    switch (random.below(7)) {
      case 0:
        add_sum();
        break;
      case 1:
        add_comparison();
        break;
      case 2:
      case 3: {
        add_comparison();
        const std::uint32_t skipped = random.below(4);
        add(0xD000U | random.below(14) << 8U | ((skipped - 1) & 0xFFU));  // b<condition>
        for (std::uint32_t k = 0; k < skipped; ++k) {
          add_sum();
        }
        break;
      }
      case 4: {
        add(0xBF00U | random.below(14) << 4U | (1U << random.below(4)));  // it: then or else, by bit 0 of the condition
        const unsigned last = static_cast<unsigned>(std::countr_zero(code[code.size() - 2] & 0xFU));
        for (unsigned k = last; k < 4; ++k) {
          add_sum();
        }
        break;
      }
      case 5:
        add(0x4800U | drawn_register() << 8U | random.below(256));  // ldr d, [pc, #]
        break;
      default:
        add(0xB108U | drawn_register());  // cbz n, over the next
        add_sum();
        add_sum();
        break;
    }
  }
  add(0xE7FEU);  // b, to itself
  return code;
}

/// State after an instruction: r0 to r7, flags and IT block, and the distance from the begin of the program.
std::vector<std::uint32_t> state_of(const CpuRig& rig, std::uint32_t program) {
  std::vector<std::uint32_t> state;
  for (unsigned number = 0; number < 8; ++number) {
    state.push_back(rig.cpu.core_register(number));
  }
  state.push_back(rig.cpu.core_register(16));
  state.push_back(rig.cpu.core_register(15) - program);
  return state;
}

TEST(RandomPrograms, GiveTheSameInRunsOfAnyLengthInStepsAndFromRam) {
  constexpr std::uint32_t in_flash = ChipMemory::flash_start + 0x1000;
  constexpr std::uint32_t in_ram = ChipMemory::ram_start + 0x1000;
  constexpr std::size_t length = 1500;
  Pcg32 random(50, 3);
  for (int round = 0; round < 40; ++round) {
    std::vector<std::uint8_t> code = random_program(random);
    const auto start = [&](CpuRig& rig, std::uint32_t program) {
      code.resize(8192, 0x11);  // what a load behind the program finds
      rig.cpu.write(program, code);
      rig.set_word(ChipMemory::flash_start, initial_stack);
      rig.set_word(ChipMemory::flash_start + 4, program | 1U);
      rig.cpu.reset();
    };
    CpuRig alone;
    start(alone, in_flash);
    std::vector<std::vector<std::uint32_t>> states{state_of(alone, in_flash)};
    while (states.size() <= length) {
      ASSERT_EQ(alone.cpu.run(1), Cpu::State::running);
      states.push_back(state_of(alone, in_flash));
    }

    CpuRig in_pieces;
    start(in_pieces, in_flash);
    for (std::size_t done = 0; done < length;) {
      const std::size_t piece = std::min<std::size_t>(1 + random.below(random.below(8) == 0 ? 700 : 12), length - done);
      in_pieces.cpu.run(piece);
      done += piece;
      ASSERT_EQ(in_pieces.cpu.instructions(), done);
      ASSERT_EQ(state_of(in_pieces, in_flash), states[done]) << "round " << round << ", " << done << " instructions";
    }

    CpuRig stepped;
    CpuRig from_ram;
    start(stepped, in_flash);
    start(from_ram, in_ram);
    for (std::size_t done = 1; done <= length; ++done) {
      stepped.cpu.step();
      from_ram.cpu.run(1);
      ASSERT_EQ(state_of(stepped, in_flash), states[done]) << "round " << round << ", " << done << " steps";
      ASSERT_EQ(state_of(from_ram, in_ram), states[done]) << "round " << round << ", " << done << " from RAM";
    }

    CpuRig stopped;
    start(stopped, in_flash);
    const std::size_t place = 1 + random.below(300);
    const std::uint32_t distance = states[place].back();
    const auto first = std::ranges::find(states, distance, [](const auto& state) { return state.back(); });
    stopped.cpu.set_breakpoints(std::array{in_flash + distance});
    ASSERT_EQ(stopped.cpu.run(length), Cpu::State::at_breakpoint);
    ASSERT_EQ(stopped.cpu.instructions(), static_cast<std::uint64_t>(first - states.begin()));
  }
}

TEST_F(CpuTest, ALoadFromBesideTheCodeFindsWhatWasProgrammedAnew) {
  constexpr std::uint32_t program = ChipMemory::flash_start + 0x13FC;  // at the end of a kilobyte
  constexpr std::uint32_t word = program + 4 + 1020;
  rig_.set_word(program, 0xE7FD'48FF);  // ldr r0, [pc, #1020]; b, to it
  rig_.set_word(ChipMemory::flash_start + 4, program | 1U);
  for (const std::uint32_t value : {0x1234'5678U, 0U, 0xFFFF'FFFFU}) {
    rig_.set_word(word, value);
    cpu_.reset();
    cpu_.run(10);
    EXPECT_EQ(cpu_.core_register(0), value);
    rig_.set_word(word, ~value);
    cpu_.run(10);
    EXPECT_EQ(cpu_.core_register(0), ~value);
  }
}

TEST_F(CpuTest, ALoadFromBesideTheCodeBehindTheEndOfTheFlashIsAFault) {
  constexpr std::uint32_t end = ChipMemory::flash_start + ChipMemory::flash_size;
  constexpr std::uint32_t program = end - 16;
  rig_.set_word(ChipMemory::flash_start + 4, program | 1U);
  for (const std::uint32_t offset : {8U, 12U}) {        // the last word, and one behind it
    rig_.set_word(program, 0xE7FD'4800U | offset / 4);  // ldr r0, [pc, #]; b, to it
    cpu_.reset();
    cpu_.run(10);
    EXPECT_EQ(cpu_.take_faults().empty(), program + 4 + offset < end) << offset;
  }
}

TEST_F(CpuTest, CodeThatIsWrittenIntoRamIsExecuted) {
  start("calls_code_in_ram");
  rig_.run(1000);
  EXPECT_EQ(rig_.marks, Marks({1, 2}));
}

TEST_F(CpuTest, CodeThatTheOwnerWritesIntoFlashIsExecuted) {
  constexpr std::uint32_t returns_1 = 0x4770'2001;  // movs r0, #1; bx lr
  rig_.set_word(0x0804'0000, returns_1);
  set_vector(16 + 1, "short_handler");
  script(0, {step::store(scs::iser, 2), step::call(address_of("calls_written_code") | 1U)});
  EXPECT_EQ(run_script(), Marks({1}));
  for (const std::uint32_t value : {2U, 3U}) {
    rig_.set_word(0x0804'0000, returns_1 - 1 + value);
    cpu_.set_interrupt(1, true);
    cpu_.set_interrupt(1, false);
    EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
    EXPECT_EQ(rig_.take_marks(), Marks({value}));
  }
}

TEST_F(CpuTest, AProgramThatProgramsTheFlashExecutesWhatItHasWritten) {
  rig_.on_flash_store = [&](const CpuRig::Store& store) {
    rig_.set_word(store.address, store.value);
    EXPECT_EQ(rig_.word(store.address), store.value) << "the owner sees it at once";
    return true;
  };
  start("programs_itself");
  rig_.run(1000);
  EXPECT_EQ(rig_.marks, Marks({1, 2}));
  EXPECT_TRUE(cpu_.take_faults().empty());
}

TEST_F(CpuTest, TheOwnerDecidesAboutAStoreToFlash) {
  std::vector<CpuRig::Store> seen;
  rig_.on_flash_store = [&](const CpuRig::Store& store) {
    seen.push_back(store);
    rig_.set_word(store.address, store.value & 0xFFFF'0000U);
    return true;
  };
  start("stores_to_flash");
  rig_.run(1000);
  EXPECT_EQ(seen, (std::vector<CpuRig::Store>{{0x0804'0000, 4, 0x1234'5678}}));
  EXPECT_EQ(rig_.marks, Marks({1, 2, 0x1234'0000}));
}

TEST_F(CpuTest, BitBandAliasesReadAndWriteSingleBits) {
  rig_.registers[0x4000'0100] = 0x8000'0001;
  start("uses_bits");
  rig_.run(1000);
  EXPECT_EQ(rig_.marks, Marks({0x7FFF'0002, 1, 0x8000'0021}));
}

TEST_F(CpuTest, AnInterruptBetweenTheInstructionsOfAnItBlockLeavesTheRestConditional) {
  const std::uint32_t within = address_of("it_across_pages") + 16;  // blocks end at pages
  set_vector(16 + 1, "reporting_handler");
  script(0, {step::store(scs::iser, 2), step::call(address_of("it_across_pages") | 1U)});
  start("reset_handler");
  while (cpu_.core_register(15) != within) {
    ASSERT_EQ(cpu_.run(1), Cpu::State::running);
  }
  EXPECT_NE(cpu_.core_register(16) & 0x0600'FC00U, 0U);
  cpu_.set_interrupt(1, true);
  cpu_.set_interrupt(1, false);
  EXPECT_EQ(cpu_.run(1000), Cpu::State::sleeping);
  ASSERT_EQ(rig_.marks.size(), 6U);
  EXPECT_EQ(rig_.marks[3] & 0x0600'FC00U, 0U) << "in the handler";
  EXPECT_EQ(rig_.marks[5], 0U);
}

TEST_F(CpuTest, StepExecutesSingleInstructions) {
  start("counted_loop");
  const std::uint32_t begin = address_of("counted_loop");
  for (const std::uint32_t offset : {2U, 4U, 8U, 10U, 12U, 2U, 4U}) {
    const std::uint64_t before = cpu_.instructions();
    cpu_.step();
    EXPECT_EQ(cpu_.core_register(15), begin + offset);
    EXPECT_EQ(cpu_.instructions(), before + 1);
  }
  cpu_.run(10'000'000);
  EXPECT_EQ(cpu_.instructions(), 1'000'001U);
}

TEST_F(CpuTest, PausesAtBreakpointsAndPassesThemWhenItContinues) {
  start("counted_loop");
  const std::uint32_t in_loop = address_of("counted_loop") + 8;
  cpu_.run(100);
  cpu_.set_breakpoints(std::array{in_loop});
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t rounds = cpu_.core_register(0);
    EXPECT_EQ(cpu_.run(1000), Cpu::State::at_breakpoint);
    EXPECT_EQ(cpu_.core_register(15), in_loop);
    if (i > 0) {
      EXPECT_EQ(cpu_.core_register(0), rounds - 1);
    }
  }
  cpu_.set_breakpoints({});
  EXPECT_EQ(cpu_.run(10'000'000), Cpu::State::sleeping);
  EXPECT_EQ(cpu_.instructions(), 1'000'001U);
}

TEST_F(CpuTest, NoBreakpointIsMissedBetweenShortRuns) {
  start("counted_loop");
  const std::uint32_t loop = address_of("counted_loop") + 2;
  cpu_.set_breakpoints(std::array{loop});
  for (std::uint32_t round = 0; round < 50; ++round) {
    Cpu::State state = Cpu::State::running;
    while (state == Cpu::State::running) {
      state = cpu_.run(1 + round % 7);
    }
    EXPECT_EQ(state, Cpu::State::at_breakpoint);
    EXPECT_EQ(cpu_.core_register(0), 199'999U - round);
  }
}

TEST_F(CpuTest, ABreakpointAtTheBeginOfAHandlerIsReached) {
  script(0, {step::store(scs::iser, 2), step::store(scs::ispr, 2), step::mark(3)});
  start("reset_handler");
  cpu_.set_breakpoints(std::array{address_of("scripted_handler")});
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::at_breakpoint);
  EXPECT_EQ(cpu_.active_exception(), 17U);
  EXPECT_EQ(cpu_.core_register(15), address_of("scripted_handler"));
  EXPECT_EQ(cpu_.run(10'000), Cpu::State::sleeping);
  EXPECT_EQ(rig_.take_marks(), Marks({0x1011, 0x2011, 3, 0x2000}));
}

TEST_F(CpuTest, RegistersCanBeReadAndWritten) {
  start("counted_loop");
  for (unsigned i = 0; i <= 14; ++i) {
    cpu_.set_core_register(i, 0x1000'0000 + 16 * i);
  }
  cpu_.set_core_register(15, address_of("compute_loop") | 1U);
  cpu_.set_core_register(16, 0xF900'0000);
  for (unsigned i = 0; i <= 14; ++i) {
    EXPECT_EQ(cpu_.core_register(i), 0x1000'0000 + 16 * i);
  }
  EXPECT_EQ(cpu_.core_register(15), address_of("compute_loop"));
  EXPECT_EQ(cpu_.core_register(16), 0xF900'0000U);
  EXPECT_THROW(static_cast<void>(cpu_.core_register(17)), std::out_of_range);
}

}  // namespace
}  // namespace proleg::sim
