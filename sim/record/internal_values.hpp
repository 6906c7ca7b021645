#pragma once

#include <cstdint>

#include "shared/kernel/kernel.hpp"

namespace proleg::sim {

// The order of internal values in recordings: slot by slot, in each the joints of its group, of each joint all values.

/// Calls use(joint, number) for every internal value of one slot. value_count: number of values of each joint.
template <typename Use>
void for_each_internal_value_of_slot(unsigned joint_count, JointMask group, std::uint32_t value_count, const Use& use) {
  for (unsigned joint = 0; joint < joint_count; ++joint) {
    for (std::uint32_t number = 0; group.contains(joint) && number < value_count; ++number) {
      use(joint, number);
    }
  }
}

/// Calls use(slot, joint, number) for every internal value of a robot.
template <typename Use>
void for_each_internal_value(const KernelConfiguration& configuration, const Use& use) {
  for (unsigned number = 0; number < max_slots; ++number) {
    const Slot& slot = configuration.slots[number];
    if (slot.algorithm == nullptr) {
      continue;
    }
    const auto count = static_cast<std::uint32_t>(slot.algorithm->declaration().internal_values.size());
    for_each_internal_value_of_slot(configuration.joint_count, slot.group, count,
                                    [&](unsigned joint, unsigned value) { use(number, joint, value); });
  }
}

}  // namespace proleg::sim
