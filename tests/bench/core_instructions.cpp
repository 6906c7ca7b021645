// Prints the costs of the core on a Cortex-M: instructions per tick and per sine, stack and memory. They are measured
// on an emulated CPU and do not depend on the computer.

#include <cstdint>
#include <cstdio>
#include <exception>
#include <string_view>

#include "shared/gait/registry.hpp"
#include "tests/cortex_m/core_costs.hpp"
#include "tests/cortex_m/core_image.hpp"

namespace {

using namespace proleg;

void print(std::string_view what, const cortex_m::Instructions& instructions) {
  std::printf("  %-36.*s %9.1f %7llu\n", static_cast<int>(what.size()), what.data(), instructions.mean,
              static_cast<unsigned long long>(instructions.worst));
}

void print_costs(cortex_m::Cpu cpu) {
  constexpr unsigned ticks = 1000;
  const cortex_m::ElfImage image(cortex_m::core_image_file(cpu));
  cortex_m::Machine machine(image, cpu);
  std::printf("%s, gcc -O3, instructions                  mean   worst\n",
              cpu == cortex_m::Cpu::cortex_m4 ? "Cortex-M4" : "Cortex-M0");
  print("sine", cortex_m::measure_sine(machine));
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const Declaration& declaration = algorithm_at(i).declaration();
    const cortex_m::TickCost cost = cortex_m::measure_tick(machine, declaration.id, ticks);
    print(declaration.name, cost.total);
    print("  set_contacts", cost.set_contacts);
    print("  receive, 4 frames", cost.receive);
    print("  advance", cost.advance);
    if (declaration.name == "SensingModule_gait_selector") {
      const auto print_deciding = [&](std::string_view what, const cortex_m::MeasuredJoint& joint) {
        print(what, cortex_m::measure_tick(machine, declaration.id, ticks, joint).total);
      };
      print_deciding("  joint 0, which decides by touch", cortex_m::deciding_joint(cortex_m::of_touch));
      cortex_m::MeasuredJoint joint = cortex_m::deciding_joint(cortex_m::of_most_features);
      print_deciding("  joint 0, by seven features", joint);
      joint.parameters.emplace_back(static_cast<std::uint32_t>(find_parameter(declaration, "dwell")), 0);
      print_deciding("  the same while its set changes", joint);
    }
  }
  std::printf("  Deepest stack, bytes (bound: core_image.stack.tsv beside the image)\n");
  for (const cortex_m::StackUse& use : cortex_m::measure_stack(machine)) {
    std::printf("    %-34s %9zu\n", use.function.c_str(), use.bytes);
  }
  const cortex_m::Sizes sizes = cortex_m::read_sizes(machine);
  std::printf("  Memory of a module's kernel, bytes: JointMemory %u, Kernel %u\n\n", sizes.joint_memory, sizes.kernel);
}

}  // namespace

int main() {
  try {
    std::puts("A tick: the middle joint of five, one slot, defaults, 1000 ticks.\n");
    print_costs(cortex_m::Cpu::cortex_m4);
    print_costs(cortex_m::Cpu::cortex_m0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_core_instructions: %s\n", error.what());
    return 1;
  }
  return 0;
}
