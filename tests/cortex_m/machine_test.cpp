// The harness itself, against functions of the image whose instructions and stack are known (known_sequences.S).

#include "tests/cortex_m/machine.hpp"

#include <gtest/gtest.h>

#include "sim/mcu/cpu/thumb.hpp"
#include "tests/cortex_m/core_image.hpp"

namespace proleg::cortex_m {
namespace {

class MachineOf : public testing::TestWithParam<Cpu> {
 protected:
  std::string error_of(std::string_view function, const std::vector<std::uint32_t>& arguments, std::uint64_t budget) {
    try {
      static_cast<void>(machine_.call(function, arguments, budget));
    } catch (const RunError& error) {
      return error.what();
    }
    return "no error";
  }

  ElfImage image_{core_image_file(GetParam())};
  Machine machine_{image_, GetParam()};
};

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

TEST_P(MachineOf, ReturnsTheValueAndCountsInstructionsOfTwoAndOfFourBytes) {
  const CallResult result = machine_.call("known_sum", {1, 20, 300, 4000}, 100);
  EXPECT_EQ(result.instructions, 7U);
  EXPECT_EQ(result.value, 1U + 20U + 300U + 4000U);
}

TEST_P(MachineOf, CountsEveryRoundOfALoop) {
  EXPECT_EQ(machine_.call("known_loop", {1}, 1'000'000).instructions, 3U);
  EXPECT_EQ(machine_.call("known_loop", {100'000}, 1'000'000).instructions, 200'001U);
}

TEST_P(MachineOf, PassesTheFifthArgumentOnTheStack) {
  EXPECT_EQ(machine_.call("known_fifth", {1, 2, 3, 4, 55}, 100).value, 55U);
}

TEST_P(MachineOf, CountsTheSameInEveryRepetition) {
  const CallResult first = machine_.call("proleg::sine", {0x12345678}, 1000);
  const CallResult second = machine_.call("proleg::sine", {0x12345678}, 1000);
  EXPECT_EQ(first.instructions, second.instructions);
  EXPECT_EQ(first.value, second.value);
}

TEST_P(MachineOf, MeasuresTheDeepestStackSinceThePaint) {
  machine_.paint_stack();
  EXPECT_EQ(machine_.stack_used(), 0U);
  static_cast<void>(machine_.call("known_stack", {}, 100));
  // Five registers are pushed; the word below them is reserved and not written.
  EXPECT_EQ(machine_.stack_used(), 20U);
  static_cast<void>(machine_.call("known_sum", {}, 100));
  EXPECT_EQ(machine_.stack_used(), 20U);
}

TEST_P(MachineOf, EndsAFunctionThatNeverReturns) {
  const std::string error = error_of("known_endless", {}, 5000);
  EXPECT_TRUE(contains(error, "more than 5000 instructions at 0x")) << error;
  EXPECT_TRUE(contains(error, "known_endless")) << error;
}

TEST_P(MachineOf, AllowsExactlyTheBudget) {
  EXPECT_EQ(machine_.call("known_sum", {}, 7).instructions, 7U);
  EXPECT_TRUE(contains(error_of("known_sum", {}, 6), "more than 6 instructions"));
}

TEST_P(MachineOf, ReportsAWriteWhereNoMemoryIs) {
  const std::string error = error_of("known_bad_write", {}, 100);
  EXPECT_TRUE(contains(error, "(known_bad_write+0)")) << error;
  EXPECT_TRUE(contains(error, "WRITE_UNMAPPED), address 0x60000000")) << error;
}

TEST_P(MachineOf, ReportsAWriteToFlash) {
  const std::string error = error_of("known_flash_write", {}, 100);
  EXPECT_TRUE(contains(error, "(known_flash_write+0)")) << error;
  EXPECT_TRUE(contains(error, "WRITE_PROT), address 0x8000000")) << error;
}

TEST_P(MachineOf, ReportsAJumpWhereNoMemoryIs) {
  const std::string error = error_of("known_bad_jump", {}, 100);
  EXPECT_TRUE(contains(error, "0x60000000 in a call of known_bad_jump")) << error;
}

TEST_P(MachineOf, ReportsAnUndefinedInstruction) {
  const std::string error = error_of("known_undefined", {}, 100);
  EXPECT_TRUE(contains(error, "known_undefined")) << error;
}

TEST_P(MachineOf, ReportsAStackOverflow) {
  const std::string error = error_of("known_overflow", {}, 1'000'000);
  EXPECT_TRUE(contains(error, "(known_overflow+0)")) << error;
}

TEST_P(MachineOf, WorksOnAfterAFault) {
  static_cast<void>(error_of("known_bad_jump", {}, 100));
  EXPECT_EQ(machine_.call("known_sum", {1, 2, 3, 4}, 100).value, 10U);
}

TEST_P(MachineOf, ReadsBackWhatItWrites) {
  const std::uint32_t address = machine_.address_of("benchmark_word");
  machine_.write_word(address, 0x12345678);
  EXPECT_EQ(machine_.read_word(address), 0x12345678U);
}

TEST_P(MachineOf, RejectsToCallWhatIsNoFunction) {
  EXPECT_TRUE(contains(error_of("benchmark_word", {}, 100), "is not a function"));
}

INSTANTIATE_TEST_SUITE_P(Processors, MachineOf, testing::Values(Cpu::cortex_m0, Cpu::cortex_m4),
                         [](const testing::TestParamInfo<Cpu>& cpu) {
                           return cpu.param == Cpu::cortex_m4 ? "CortexM4" : "CortexM0";
                         });

TEST(Thumb, AnInstructionHasTwoOrFourBytes) {
  EXPECT_EQ(sim::instruction_size(0x4770), 2U);  // bx lr
  EXPECT_EQ(sim::instruction_size(0xE7FE), 2U);  // b .
  EXPECT_EQ(sim::instruction_size(0xE92D), 4U);  // stmdb
  EXPECT_EQ(sim::instruction_size(0xF000), 4U);  // bl
  EXPECT_EQ(sim::instruction_size(0xFB01), 4U);  // mul and the like
}

}  // namespace
}  // namespace proleg::cortex_m
