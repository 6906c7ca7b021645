#include "shared/computer/master/setup_list.hpp"

#include "shared/canopen/objects.hpp"

namespace proleg::canopen {
namespace {

/// Counts writes and keeps the write at a position.
class WriteAtPosition {
 public:
  explicit WriteAtPosition(std::size_t position) : position_(position) {}

  void operator()(Address address, DataType type, std::uint32_t value) {
    if (count_ == position_) {
      found_ = {address, size_of(type), value};
    }
    ++count_;
  }
  void operator()(const Object& object, std::uint32_t value) { (*this)(object.address, object.type, value); }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] const SdoRequest& found() const { return found_; }

 private:
  std::size_t position_;
  std::size_t count_ = 0;
  SdoRequest found_{};
};

}  // namespace

SetupList::SetupList(const RobotSetup& setup, unsigned joint)
    : setup_(setup), joint_(joint), second_channel_(setup.kernel.second_channel_senders()) {
  const std::size_t joints = setup.kernel.joint_count;
  if (joint >= joints || joints > max_joints || setup.nodes.size() != joints || setup.limits.size() != joints) {
    return;
  }
  collect_start_values();
  WriteAtPosition counter(0);
  visit_all(counter);
  size_ = counter.count();
}

SdoRequest SetupList::at(std::size_t position) const {
  WriteAtPosition write(position);
  visit_all(write);
  return write.found();
}

void SetupList::collect_start_values() {
  for (const Setting& start : setup_.start_values) {
    if (start.joint != joint_ || start.slot >= max_slots) {
      continue;
    }
    const Slot& slot = setup_.kernel.slots[start.slot];
    if (slot.algorithm == nullptr || !slot.group.contains(joint_) ||
        start.number >= slot.algorithm->declaration().parameters.size()) {
      continue;
    }
    const bool differs = start.value != slot.algorithm->declaration().parameters[start.number].default_value;
    const std::uint32_t bit = 1U << start.number;
    start_values_[start.slot][start.number] = start.value;
    to_write_[start.slot] = (to_write_[start.slot] & ~bit) | (differs ? bit : 0);
  }
}

template <typename Visitor>
void SetupList::visit_all(Visitor& visitor) const {
  const KernelConfiguration& kernel = setup_.kernel;
  visitor(object::host_heartbeat, std::uint32_t{host_node} << 16U | host_timeout_ms);
  visitor(object::heartbeat_period, heartbeat_period_ms);
  visitor(object::tick_period, kernel.tick_period_us);
  visitor(object::sync_counter_overflow, object::sync_counter_overflow.default_value);

  visitor(object::joint_index, joint_);
  visitor(object::joint_count, kernel.joint_count);
  visitor(object::front_node, joint_ == 0 ? 0U : setup_.nodes[joint_ - 1]);
  visitor(object::rear_node, joint_ + 1 == kernel.joint_count ? 0U : setup_.nodes[joint_ + 1]);
  visitor(object::robot_id, setup_.robot_id);
  visitor(object::seed_low, static_cast<std::uint32_t>(kernel.seed));
  visitor(object::seed_high, static_cast<std::uint32_t>(kernel.seed >> 32U));
  visitor(object::servo_period, setup_.servo_period_us);
  visitor(object::command_speed, setup_.command_speed);
  for (unsigned i = 0; i < max_slots; ++i) {
    const std::uint64_t group = kernel.slots[i].driven_joints().bits();
    visitor(object::slot_algorithm.address(i), object::slot_algorithm.first.type, kernel.slots[i].algorithm_id());
    visitor(object::slot_group_low.address(i), object::slot_group_low.first.type, static_cast<std::uint32_t>(group));
    visitor(object::slot_group_high.address(i), object::slot_group_high.first.type,
            static_cast<std::uint32_t>(group >> 32U));
  }
  for (unsigned other = 0; other < kernel.joint_count; ++other) {
    if (other == joint_) {
      continue;
    }
    const unsigned channels = second_channel_.contains(other) ? 2 : 1;
    for (unsigned channel = 0; channel < channels; ++channel) {
      const JointObjects& entry = object::state_frame_identifier[channel];
      visitor(entry.address(other), entry.first.type, identifier::state_frames[channel] + setup_.nodes[other]);
    }
  }
  visitor(object::activate, 1);

  visitor(object::lower_limit, static_cast<std::uint32_t>(setup_.limits[joint_].lower));
  visitor(object::upper_limit, static_cast<std::uint32_t>(setup_.limits[joint_].upper));
  for (std::uint8_t slot = 0; slot < max_slots; ++slot) {
    for (std::uint8_t parameter = 0; parameter < max_parameters; ++parameter) {
      if ((to_write_[slot] >> parameter & 1U) != 0) {
        const ValueAddress value{ValueKind::parameter, kernel.slots[slot].algorithm_id(), parameter, slot};
        visitor(address_of(value), DataType::integer32, static_cast<std::uint32_t>(start_values_[slot][parameter]));
      }
    }
  }
}

}  // namespace proleg::canopen
