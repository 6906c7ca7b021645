// Programs that stop: the watchdog, and the report of a fault on the console.

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

std::string hex(std::uint32_t value) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%08x", value);
  return text.data();
}

/// Whether the console prints `words` behind its first `from` bytes, within 500 ms.
bool prints(ChipRig& rig, std::size_t from, const std::string& words) {
  return rig.run_until_true([&] { return rig.board.console.find(words, from) != std::string::npos; }, 500 * ms);
}

TEST(ChipWatchdog, ResetsTwoHundredMillisecondsAfterItWasFedLast) {
  // At 32 kHz: 400 counts of 16 periods. It is fed every 50 ms at least.
  for (BusTime phase = 0; phase < 50 * ms; phase += 7 * ms) {
    ChipRig rig;
    rig.boot();
    rig.run_for(phase);
    rig.break_program({branch_to_itself});
    const BusTime hung = rig.bus.now();
    ASSERT_TRUE(rig.run_until_true([&] { return !rig.events.empty(); }, 300 * ms));
    EXPECT_EQ(rig.events[0].kind, ChipEvent::Kind::reset);
    EXPECT_EQ(rig.events[0].cause, ResetCause::independent_watchdog);
    EXPECT_GE(rig.events[0].time, hung + 149 * ms);
    EXPECT_LE(rig.events[0].time, hung + 201 * ms);
  }
}

TEST(ChipWatchdog, DoesNotResetWhileTheProgramRuns) {
  ChipRig rig;
  rig.start_robot(20'000);
  rig.run_for(3'000 * ms);
  EXPECT_TRUE(rig.events.empty());
}

TEST(ChipWatchdog, IsReportedByTheNextStart) {
  ChipRig rig;
  rig.boot();
  const std::size_t before = rig.board.console.size();
  rig.break_program({branch_to_itself});
  ASSERT_TRUE(rig.run_until_true([&] { return !rig.events.empty(); }, 300 * ms));
  rig.mend_program();
  const BusTime reset = rig.bus.now();
  EXPECT_TRUE(prints(rig, before, "started by watchdog\r\n"));
  rig.run_for(50 * ms);
  EXPECT_EQ(rig.board.console.find("stopped by"), std::string::npos);
  ASSERT_EQ(rig.frames(0x703, reset).size(), 1U);
  const std::vector<LoggedFrame> emergencies = rig.frames(0x083, reset);
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergencies[0].frame, (CanFrame{0x083, 8, {0x10, 0x60, emergencies[0].frame.data[2]}}));
  EXPECT_GT(emergencies[0].time, rig.frames(0x703, reset)[0].time);
}

TEST(ChipFault, IsPrintedAfterTheRestartWithTheRegistersOfThatTime) {
  ChipRig rig;
  rig.boot();
  const std::size_t before = rig.board.console.size();
  rig.break_program({undefined_instruction});
  ASSERT_TRUE(rig.run_until_true([&] { return rig.events.size() >= 2; }, 300 * ms));
  rig.mend_program();
  const ChipEvent& fault = rig.events[0];
  ASSERT_EQ(fault.kind, ChipEvent::Kind::fault);
  ASSERT_EQ(rig.events[1].kind, ChipEvent::Kind::reset);
  EXPECT_EQ(rig.events[1].cause, ResetCause::software);
  EXPECT_LT(rig.events[1].time, fault.time + 100 * us);
  constexpr std::size_t lr = 14;
  constexpr std::size_t pc = 15;
  const std::uint32_t place = fault.registers.at(pc);
  EXPECT_TRUE(place == rig.address_of("pend_sv_handler") || place == rig.address_of("tim5_handler"));
  // PM0214, 4.4.14 and 4.4.16: UNDEFINSTR and FORCED. EXC_RETURN: to thread mode, main stack.
  EXPECT_EQ(fault.registers.at(lr), 0xFFFF'FFF9U);
  EXPECT_TRUE(
      prints(rig, before, "started by fault\r\nstopped by: processor fault, pc " + hex(place) + ", lr fffffff9, sp "));
  EXPECT_TRUE(prints(rig, before, ", cfsr 00010000, hfsr 40000000, address 00000000\r\n"));
}

TEST(ChipFault, IsReportedOnTheBusOnceAndTheStartAfterIsLikeAnyOther) {
  ChipRig rig;
  rig.boot();
  rig.break_program({undefined_instruction});
  ASSERT_TRUE(rig.run_until_true([&] { return rig.events.size() >= 2; }, 300 * ms));
  rig.mend_program();
  const BusTime reset = rig.bus.now();
  rig.run_for(100 * ms);
  const std::vector<LoggedFrame> emergencies = rig.frames(0x083, reset);
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergency_code(emergencies[0]), 0x6100U);
  std::uint32_t detail = 0;
  for (unsigned i = 0; i < 4; ++i) {
    detail |= std::uint32_t{emergencies[0].frame.data[3 + i]} << 8U * i;
  }
  EXPECT_EQ(detail, rig.events[0].registers[15]) << "the place in the program";

  const std::size_t before = rig.board.console.size();
  rig.power_on();
  EXPECT_TRUE(prints(rig, before, "started by power on\r\n"));
  rig.run_for(100 * ms);
  EXPECT_EQ(rig.board.console.find("stopped by", before), std::string::npos) << "the record is read once";
}

TEST(ChipFault, ThatComesAgainAtEachStartIsPrintedEachTime) {
  ChipRig rig;
  rig.boot();
  rig.break_program({undefined_instruction});
  rig.run_for(300 * ms);
  EXPECT_GE(rig.events.size(), 20U) << "fault and reset, every few milliseconds";
  rig.mend_program();
  EXPECT_TRUE(prints(rig, rig.board.console.size(), "stopped by: processor fault, pc "));
}

// The model of the chip has no fault below the RAM but that of the MPU.
TEST(ChipFault, APushBelowTheRamLocksTheProcessorUpAndTheWatchdogComes) {
  // movs r3, #1; lsls r3, r3, #29; mov sp, r3; push {r0}: the begin of the RAM, where the stack ends
  ChipRig rig;
  rig.boot();
  const std::size_t before = rig.board.console.size();
  rig.break_program({0x2301, 0x075B, 0x469D, 0xB401});
  ASSERT_TRUE(rig.run_until_true([&] { return rig.events.size() >= 3; }, 500 * ms));
  rig.mend_program();
  EXPECT_EQ(rig.events[0].kind, ChipEvent::Kind::fault);
  EXPECT_EQ(rig.events[1].kind, ChipEvent::Kind::locked_up);
  EXPECT_EQ(rig.events[2].kind, ChipEvent::Kind::reset);
  EXPECT_EQ(rig.events[2].cause, ResetCause::independent_watchdog);
  EXPECT_TRUE(prints(rig, before, "started by watchdog\r\n"));
}

TEST(ChipFault, AnInterruptThatFindsNoStackIsAFaultWithItsRecord) {
  // ARMv7-M, B1.5.12: the error of the stacking (CFSR.MSTKERR) is taken in the interrupt's place, without another
  // stacking.
  ChipRig rig;
  rig.boot();
  const std::size_t before = rig.board.console.size();
  rig.chip.cpu().set_core_register(13, 0x2000'0000);
  ASSERT_TRUE(rig.run_until_true([&] { return rig.events.size() >= 2; }, 500 * ms));
  EXPECT_EQ(rig.events.back().cause, ResetCause::software);
  EXPECT_TRUE(prints(rig, before, "stopped by: processor fault, pc 00000000, lr 00000000, sp 1fff"));
  EXPECT_TRUE(prints(rig, before, ", cfsr 00000010, hfsr 40000000, "));
}

}  // namespace
}  // namespace proleg::sim
