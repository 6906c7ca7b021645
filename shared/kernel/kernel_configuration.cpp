#include "shared/kernel/kernel_configuration.hpp"

namespace proleg {

JointMask KernelConfiguration::second_channel(unsigned slot) const {
  if (!slots[slot].broadcasts()) {
    return {};
  }
  JointMask earlier;
  for (unsigned i = 0; i < slot; ++i) {
    earlier |= slots[i].broadcasts() ? slots[i].group : JointMask();
  }
  return slots[slot].group & earlier;
}

JointMask KernelConfiguration::second_channel_senders() const {
  JointMask senders;
  for (unsigned i = 0; i < max_slots; ++i) {
    senders |= second_channel(i);
  }
  return senders;
}

}  // namespace proleg
