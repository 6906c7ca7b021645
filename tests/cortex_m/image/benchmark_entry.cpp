// Entry points for the counts of instructions and stack: five modules that the harness drives call by call, so that it
// measures the kernel's own functions only.

#include <array>

#include "shared/gait/registry.hpp"
#include "shared/kernel/kernel.hpp"

namespace {

constexpr unsigned joint_count = 5;

std::array<proleg::KernelOf<1>, joint_count> kernels;
proleg::KernelConfiguration configuration;

}  // namespace

extern "C" {

/// Sizes in bytes, for the harness to read.
extern const std::uint32_t size_of_joint_memory = sizeof(proleg::JointMemory);
extern const std::uint32_t size_of_kernel = sizeof(proleg::Kernel);

/// For the test of the memory access of the harness.
std::uint32_t benchmark_word;

/// An algorithm in one slot, on all joints. For Kernel::configure.
const proleg::KernelConfiguration* benchmark_configuration(std::uint32_t algorithm_id) {
  configuration = {};
  configuration.joint_count = joint_count;
  configuration.slots[0] = {proleg::find_algorithm(static_cast<std::uint8_t>(algorithm_id)),
                            proleg::JointMask::first(joint_count)};
  return &configuration;
}

proleg::Kernel* benchmark_kernel(std::uint32_t joint) { return &kernels[joint]; }

/// The frame that a joint sends.
const proleg::StateFrame* benchmark_frame(std::uint32_t joint) {
  return &static_cast<const proleg::Kernel&>(kernels[joint]).frame(joint, 0);
}

/// Gives a joint readings of all sensors, which change with the ticks.
void benchmark_set_readings(std::uint32_t joint, std::uint32_t tick) {
  proleg::JointReadings readings;
  readings.present = proleg::JointReadings::all_sensors;
  const auto changing = static_cast<std::int32_t>((tick + joint) * 0x9E37'79B9U);
  readings.current_ma = changing & 0x7FFF;
  readings.pitch = changing >> 1;
  readings.roll = changing;
  readings.angle = -readings.pitch;
  kernels[joint].set_readings(joint, readings);
}

/// The tick of a joint after the other joints have advanced, in one call.
void benchmark_tick(std::uint32_t joint, std::uint32_t contacts) {
  proleg::Kernel& kernel = kernels[joint];
  kernel.set_contacts(joint, static_cast<std::uint8_t>(contacts));
  kernel.advance();
  for (std::uint32_t sender = 0; sender < joint_count; ++sender) {
    if (sender != joint) {
      static_cast<void>(kernel.receive(sender, 0, *benchmark_frame(sender)));
    }
  }
}

}  // extern "C"
