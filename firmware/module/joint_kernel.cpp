#include "firmware/module/joint_kernel.hpp"

#include "shared/canopen/robot_configuration.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::firmware {

KernelConfiguration ModuleSettings::kernel() const {
  KernelConfiguration configuration;
  configuration.joint_count = joint_count;
  configuration.tick_period_us = tick_period_us;
  configuration.seed = seed;
  for (std::size_t slot = 0; slot < max_slots; ++slot) {
    if (algorithms[slot] != 0) {
      configuration.slots[slot] = {find_algorithm(algorithms[slot]), JointMask(groups[slot])};
    }
  }
  return configuration;
}

std::uint32_t ModuleSettings::crc(std::uint8_t own_node) const {
  std::array<std::uint8_t, max_joints> robot = nodes[0];
  robot[joint] = own_node;
  return canopen::configuration_crc({kernel(), robot_id, servo_period_us, {robot.data(), joint_count}});
}

void JointKernel::deactivate() {
  active_ = false;
  record_.tick = TickRecord::none;
  limits_ = full_range;
}

Status JointKernel::activate(const ModuleSettings& settings, std::uint8_t node) {
  deactivate();
  if (const Status status = kernel_.configure(settings.kernel(), settings.joint); status != Status::ok) {
    return status;
  }
  robot_id_ = settings.robot_id;
  crc_ = settings.crc(node);
  monitoring_period_ = canopen::monitoring_period(kernel_.configuration());
  debouncer_.reset();
  checksum_.restart();
  active_ = true;
  return Status::ok;
}

const ActuationModule* JointKernel::algorithm(unsigned slot) const {
  return kernel_.drives(slot, joint()) ? kernel_.configuration().slots[slot].algorithm : nullptr;
}

bool JointKernel::has_algorithm(unsigned slot, std::uint8_t id) const {
  const ActuationModule* found = algorithm(slot);
  return found != nullptr && found->declaration().id == id;
}

Status JointKernel::set_limits(const AngleLimits& limits) {
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
  set_flags(0);
  kernel_.reset();
  debouncer_.reset();
  checksum_.restart();
  record_.tick = TickRecord::none;
}

void JointKernel::join(std::uint32_t tick) {
  kernel_.join(tick);
  checksum_.lose();
  record_.tick = TickRecord::none;
}

void JointKernel::set_flags(unsigned flags) {
  kernel_.set_flags(static_cast<std::uint8_t>(fault_ ? flags | StateFrame::fault : flags));
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

void JointKernel::compute_tick() {
  kernel_.advance();
  checksum_.add(kernel_.setpoint(joint()));
}

void JointKernel::advance(unsigned missed, std::uint8_t sensors, std::uint16_t current_ma) {
  const unsigned flags = missed == 0 ? 0U : unsigned{StateFrame::holdover};
  for (unsigned i = 0; i < missed; ++i) {
    set_flags(flags);
    compute_tick();
  }
  set_flags(flags);
  kernel_.set_contacts(joint(), debouncer_.sample(sensors));
  JointReadings readings;
  readings.present = JointReadings::servo_current;
  readings.current_ma = current_ma;
  kernel_.set_readings(joint(), readings);
  record_.current_ma = current_ma;
  compute_tick();
  write_record();
}

void JointKernel::write_record() {
  record_.tick = kernel_.tick() - 1U;
  record_.setpoint = kernel_.setpoint(joint());
  record_.joint = static_cast<std::uint8_t>(joint());
  record_.flags = kernel_.frame(joint(), 0).flags();
  record_.value_count = 0;
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    const ActuationModule* in_slot = algorithm(slot);
    const std::size_t count = in_slot == nullptr ? 0 : in_slot->declaration().internal_values.size();
    for (unsigned number = 0; number < count; ++number) {
      record_.internal_values[record_.value_count++] = kernel_.internal_value(slot, joint(), number);
    }
  }
}

}  // namespace proleg::firmware
