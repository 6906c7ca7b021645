#include "firmware/module/joint_kernel.hpp"

namespace proleg::firmware {

void JointKernel::deactivate() {
  active_ = false;
  limits_ = full_range;
}

Status JointKernel::activate(const Settings& settings, std::uint8_t node) {
  deactivate();
  if (const Status status = kernel_.configure(settings.kernel(), settings.joint); status != Status::ok) {
    return status;
  }
  robot_id_ = settings.robot_id;
  crc_ = settings.crc(node);
  debouncer_.reset();
  active_ = true;
  return Status::ok;
}

const ActuationModule* JointKernel::algorithm(unsigned slot) const {
  return kernel_.drives(slot, joint()) ? kernel_.configuration().slots[slot].algorithm : nullptr;
}

Status JointKernel::set_limits(const canopen::AngleLimits& limits) {
  const Status status = kernel_.set_limits(joint(), limits.lower, limits.upper);
  if (status == Status::ok) {
    limits_ = limits;
  }
  return status;
}

Status JointKernel::set_parameter(unsigned slot, unsigned number, std::int32_t value) {
  return kernel_.set_parameter(slot, joint(), number, value);
}

void JointKernel::restart() {
  kernel_.set_flags(0);
  kernel_.reset();
  debouncer_.reset();
}

Status JointKernel::open(std::uint16_t transaction) { return kernel_.open(transaction); }

Status JointKernel::stage(unsigned slot, unsigned number, bool internal, std::int32_t value) {
  const std::uint16_t transaction = kernel_.open_transaction();
  return internal ? kernel_.stage_internal(transaction, slot, joint(), number, value)
                  : kernel_.stage(transaction, slot, joint(), number, value);
}

std::int32_t JointKernel::staged_parameter(unsigned slot, unsigned number) const {
  std::int32_t value = 0;
  return kernel_.staged_value(slot, joint(), number, false, value) ? value : kernel_.parameter(slot, joint(), number);
}

Status JointKernel::commit(std::uint16_t transaction, std::uint32_t tick) { return kernel_.commit(transaction, tick); }

void JointKernel::advance(unsigned missed, std::uint8_t sensors) {
  const auto flags = static_cast<std::uint8_t>(missed == 0 ? 0 : StateFrame::holdover);
  for (unsigned i = 0; i < missed; ++i) {
    kernel_.set_flags(flags);
    kernel_.advance();
  }
  kernel_.set_flags(flags);
  kernel_.set_contacts(joint(), debouncer_.sample(sensors));
  kernel_.advance();
}

}  // namespace proleg::firmware
