#pragma once

#include <cstdint>
#include <vector>

#include "shared/kernel/kernel.hpp"

namespace proleg::sim {

/// Calls use(slot, joint, number) for every internal value of a robot in the order of TickSample::internal_values: slot
/// by slot, in each the joints of its group, of each joint all values.
template <typename Use>
void for_each_internal_value(const KernelConfiguration& configuration, const Use& use) {
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    const Slot& place = configuration.slots[slot];
    if (place.algorithm == nullptr) {
      continue;
    }
    const auto count = static_cast<unsigned>(place.algorithm->declaration().internal_values.size());
    for (unsigned joint = 0; joint < configuration.joint_count; ++joint) {
      for (unsigned number = 0; place.group.contains(joint) && number < count; ++number) {
        use(slot, joint, number);
      }
    }
  }
}

}  // namespace proleg::sim
