// Programs that fail while the robot crawls. They are reported, their watchdog restarts them, and the other modules
// continue as if the broken one had been switched off.

#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

constexpr unsigned broken_joint = 2;
constexpr std::uint32_t breaks_at = 200;
const char* const broken_function = "proleg::firmware::Module::handle";
const char* const servo_function = "proleg::stm32f405::Servo::pulse";

/// Thumb instructions, and words that they load.
class Code {
 public:
  Code& op(std::uint16_t halfword) {
    bytes_.push_back(static_cast<std::uint8_t>(halfword));
    bytes_.push_back(static_cast<std::uint8_t>(halfword >> 8U));
    return *this;
  }
  Code& word(std::uint32_t value) {
    return op(static_cast<std::uint16_t>(value)).op(static_cast<std::uint16_t>(value >> 16U));
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Writes code over the begin of a function while the module runs, and can restore it.
class Patch {
 public:
  Patch(Stm32f405& chip, const Code& code, const char* function = broken_function)
      : chip_(chip), address_(flashed_image().flash().elf().symbol(function).address), before_(code.bytes().size()) {
    chip_.read(address_, before_);
    chip_.write(address_, code.bytes());
  }
  void restore() { chip_.write(address_, before_); }
  [[nodiscard]] std::uint32_t address() const { return address_; }

 private:
  Stm32f405& chip_;
  std::uint32_t address_;
  std::vector<std::uint8_t> before_;
};

constexpr std::uint16_t nop = 0xBF00;
constexpr std::uint16_t branch_to_itself = 0xE7FE;
constexpr std::uint16_t undefined = 0xDE00;             // udf #0
constexpr std::uint16_t return_from_function = 0x4770;  // bx lr
constexpr std::uint16_t store_r3_at_r3 = 0x601B;        // str r3, [r3]
constexpr std::uint16_t load_r3_behind_next = 0x4B00;   // ldr r3, [pc, #0], from a multiple of 4

/// A store to an address, of that address.
Code store_to(std::uint32_t address) {
  const bool aligned = flashed_image().flash().elf().symbol(broken_function).address % 4 == 0;
  Code code;
  if (!aligned) {
    code.op(nop);
  }
  return code.op(load_r3_behind_next).op(store_r3_at_r3).word(address);
}

/// Runs on with one broken module, and expects no difference of the others.
void expect_others_to_continue(VirtualRobot& robot) {
  robot.run_to(breaks_at + 150);
  for (unsigned joint = 0; joint < 5; ++joint) {
    if (joint != broken_joint) {
      EXPECT_EQ(robot.loop().differences(joint), 0U) << "joint " << joint;
    }
  }
  EXPECT_GT(robot.loop().differences(broken_joint), 0U) << "what a broken program omits is a difference";
  ASSERT_FALSE(robot.loop().failures().empty());
  EXPECT_EQ(robot.loop().failures()[0].joint, broken_joint);
  EXPECT_LE(robot.loop().failures()[0].tick, breaks_at + 1);
}

TEST(HungProgram, IsResetByItsWatchdogAndReportedAndTheOthersContinue) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(breaks_at);
  const Patch patch(robot.module(broken_joint).chip(), Code().op(branch_to_itself));
  expect_others_to_continue(robot);
  EXPECT_TRUE(robot.was_noticed("J3 (node 3): at ") && robot.was_noticed("reset by its watchdog"));
}

TEST(HungProgram, ThatHasSentItsStateMisleadsNoNeighbour) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(breaks_at);
  const Patch patch(robot.module(broken_joint).chip(), Code().op(branch_to_itself), servo_function);
  expect_others_to_continue(robot);
}

TEST(HungProgram, ThatWorksAfterItsResetJoinsAgainAndReportsWhyItStarted) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(breaks_at);
  Patch patch(robot.module(broken_joint).chip(), Code().op(branch_to_itself));
  std::uint32_t tick = breaks_at;
  while (!robot.was_noticed("watchdog") && tick < breaks_at + 100) {
    robot.run_to(++tick);
  }
  patch.restore();
  EXPECT_GE(tick, breaks_at + 10U) << "a watchdog of some 200 ms, by an RC oscillator";
  EXPECT_LE(tick, breaks_at + 40U);
  const std::uint64_t differences = robot.loop().differences();
  robot.run_to(breaks_at + 200);
  ASSERT_EQ(robot.joined.size(), 1U);
  EXPECT_EQ(robot.joined[0].first, broken_joint);
  EXPECT_EQ(robot.loop().differences(), differences) << "once it is back, nothing differs";
  EXPECT_TRUE(robot.was_noticed("0x6010")) << "EMCY: software reset, watchdog";
  EXPECT_TRUE(std::ranges::any_of(robot.console, [](const auto& line) {
    return line.first == broken_joint && line.second.find("watchdog") != std::string::npos;
  }));
}

TEST(FaultyProgram, ThatWritesWithoutMemoryIsNamedWithRegistersAndBackTrace) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(breaks_at);
  Patch patch(robot.module(broken_joint).chip(), store_to(0x2003'0000));
  std::uint32_t tick = breaks_at;
  while (!robot.was_noticed("fault of the program") && tick < breaks_at + 5) {
    robot.run_to(++tick);
  }
  patch.restore();
  robot.run_to(breaks_at + 150);
  EXPECT_TRUE(robot.was_noticed("0x20030000"));
  EXPECT_TRUE(robot.was_noticed("r3 0x20030000")) << "registers";
  EXPECT_TRUE(robot.was_noticed("proleg::firmware::Module::handle")) << "back trace";
  EXPECT_TRUE(robot.was_noticed("ModuleTask")) << "its caller";
  EXPECT_TRUE(robot.was_noticed("0x6100")) << "EMCY: internal software error";
  ASSERT_EQ(robot.joined.size(), 1U);
  EXPECT_EQ(robot.joined[0].first, broken_joint) << "the handler of the fault starts it again";
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_TRUE(joint == broken_joint || robot.loop().differences(joint) == 0) << "joint " << joint;
  }
}

TEST(FaultyProgram, WithAnUndefinedInstructionIsNamed) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(breaks_at);
  const Patch patch(robot.module(broken_joint).chip(), Code().op(undefined));
  expect_others_to_continue(robot);
  EXPECT_TRUE(robot.was_noticed("undefined instruction"));
}

TEST(FaultyProgram, ThatStoresToLockedFlashChangesNothingThere) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(breaks_at);
  constexpr std::uint32_t address = 0x0800'8000;  // the board record
  std::vector<std::uint8_t> before(64);
  robot.module(broken_joint).chip().read(address, before);
  const Patch patch(robot.module(broken_joint).chip(), store_to(address));
  robot.run_to(breaks_at + 50);
  std::vector<std::uint8_t> after(64);
  robot.module(broken_joint).chip().read(address, after);
  EXPECT_EQ(after, before);
}

TEST(ProgramBeyondTheModel, StandsStillAndIsNamedWithTheRegisterAndThePlace) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(breaks_at);
  const Patch patch(robot.module(broken_joint).chip(), store_to(0x4001'3000));
  expect_others_to_continue(robot);
  EXPECT_TRUE(robot.was_noticed("SPI1"));
  EXPECT_TRUE(robot.was_noticed("proleg::firmware::Module::handle"));
  EXPECT_TRUE(robot.joined.empty());
}

// The handler of the fault returns to the instruction that failed.
TEST(FaultyProgram, ThatHasTheSameFaultAgainAndAgainStandsStillAndIsNamed) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(breaks_at);
  Stm32f405& chip = robot.module(broken_joint).chip();
  const Patch handler(chip, Code().op(return_from_function), "fault_handler");
  const Patch patch(chip, Code().op(undefined));
  expect_others_to_continue(robot);
  EXPECT_TRUE(robot.was_noticed("undefined instruction"));
  EXPECT_TRUE(robot.was_noticed("more than 100 faults since the reset"));
  const auto faults = std::ranges::count_if(
      robot.notices, [](const std::string& text) { return text.find("fault of the program") != std::string::npos; });
  EXPECT_EQ(faults, 5) << "the first ones";
}

TEST(BrokenProgram, InTheModuleThatSendsTheTicksEndsTheRunWithAReason) {
  VirtualRobot robot(shipped("travelling_wave/coupled"));
  robot.run_to(50);
  const Patch patch(robot.module(0).chip(), Code().op(branch_to_itself));
  EXPECT_THROW(robot.run_to(300), HardwareError);
}

}  // namespace
}  // namespace proleg::sim
