// What the core may cost. Instruction counts and stack are the same on every computer.

#include "tests/cortex_m/core_costs.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string_view>

#include "shared/gait/registry.hpp"
#include "tests/cortex_m/core_image.hpp"

namespace proleg::cortex_m {
namespace {

constexpr std::uint8_t sinusoidal = 2;
constexpr std::uint8_t coupled_oscillator = 4;
constexpr unsigned ticks = 1000;

class CostOnCortexM4 : public testing::Test {
 protected:
  ElfImage image_{core_image_file(Cpu::cortex_m4)};
  Machine machine_{image_, Cpu::cortex_m4};
};

TEST_F(CostOnCortexM4, ATickOfTheSinusoidalGeneratorTakesAtMost600Instructions) {
  EXPECT_LE(measure_tick(machine_, sinusoidal, ticks).total.worst, 600U);
}

TEST_F(CostOnCortexM4, ATickOfTheCoupledOscillatorTakesAtMost1500Instructions) {
  EXPECT_LE(measure_tick(machine_, coupled_oscillator, ticks).total.worst, 1500U);
}

TEST_F(CostOnCortexM4, ATickOfAnyAlgorithmTakesAtMost2500Instructions) {
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const Declaration& declaration = algorithm_at(i).declaration();
    EXPECT_LE(measure_tick(machine_, declaration.id, ticks).total.worst, 2500U) << declaration.name;
  }
}

TEST_F(CostOnCortexM4, TheGaitSelectorAddsAtMost800InstructionsToATickOfTheJointThatChooses) {
  const auto id_of = [](std::string_view name) { return find_algorithm(name)->declaration().id; };
  const Instructions with_least = measure_tick(machine_, id_of("DirectJointAccess"), ticks).total;
  for (const auto& features : {of_touch, of_most_features}) {
    const Instructions chooses =
        measure_tick(machine_, id_of("SensingModule_gait_selector"), ticks, deciding_joint(features)).total;
    EXPECT_LE(chooses.worst, with_least.worst + 800);
  }
}

TEST_F(CostOnCortexM4, ASineTakesAtMost50Instructions) { EXPECT_LE(measure_sine(machine_).worst, 50U); }

TEST_F(CostOnCortexM4, ATickInOneCallCostsItsPartsAndTheCallsOfThem) {
  constexpr double parts = 6;  // contacts, advance, four frames
  for (const std::uint8_t algorithm : {sinusoidal, coupled_oscillator}) {
    const TickCost cost = measure_tick(machine_, algorithm, 100);
    const double calls = measure_whole_tick(machine_, algorithm, 100).mean - cost.total.mean;
    std::cout << "algorithm " << unsigned{algorithm} << ": receive " << cost.receive.mean << ", calls " << calls
              << '\n';
    // Arguments, loop and branch. A frame takes 33: one that is missing or counted twice leaves this range.
    EXPECT_GE(calls, 8 * parts);
    EXPECT_LE(calls, 16 * parts);
  }
}

/// Stack of the kernel's functions: measured, at most the bound that tools/stack_bound computes, and that at most
/// `limit`.
class StackOfKernel : public testing::TestWithParam<Cpu> {
 protected:
  static constexpr std::size_t limit = 512;

  /// The file that the cross build writes beside the image.
  static std::map<std::string, std::size_t> read_bounds() {
    std::filesystem::path file = core_image_file(GetParam());
    std::ifstream stream(file.replace_extension(".stack.tsv"));
    std::map<std::string, std::size_t> bounds;
    std::string function;
    std::size_t bytes = 0;
    while (stream >> function >> bytes) {
      bounds[function] = bytes;
    }
    return bounds;
  }
};

TEST_P(StackOfKernel, StaysWithinItsComputedBoundAndThatWithin512Bytes) {
  const ElfImage image(core_image_file(GetParam()));
  Machine machine(image, GetParam());
  const std::map<std::string, std::size_t> bounds = read_bounds();
  const std::vector<StackUse> uses = measure_stack(machine);
  EXPECT_EQ(uses.size(), 6U);
  for (const StackUse& use : uses) {
    ASSERT_TRUE(bounds.contains(use.function)) << use.function;
    const std::size_t bound = bounds.at(use.function);
    EXPECT_LE(use.bytes, bound) << use.function;
    EXPECT_LE(bound, limit) << use.function;
    std::cout << use.function << ": measured " << use.bytes << ", bound " << bound << " bytes\n";
  }
}

INSTANTIATE_TEST_SUITE_P(Processors, StackOfKernel, testing::Values(Cpu::cortex_m0, Cpu::cortex_m4),
                         [](const testing::TestParamInfo<Cpu>& cpu) {
                           return cpu.param == Cpu::cortex_m4 ? "CortexM4" : "CortexM0";
                         });

}  // namespace
}  // namespace proleg::cortex_m
