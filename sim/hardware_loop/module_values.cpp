#include "sim/hardware_loop/module_values.hpp"

#include <array>
#include <cstddef>

#include "sim/loop/touch_inputs.hpp"
#include "sim/record/internal_values.hpp"

namespace proleg::sim {

ModuleValues::ModuleValues(const Scenario& scenario, const ModuleRack& rack, const ReferenceGait& reference)
    : scenario_(scenario),
      rack_(rack),
      reference_(reference),
      setpoints_(reference.chain().setpoints().begin(), reference.chain().setpoints().end()),
      latched_contacts_(scenario.robot.links.size()) {
  for_each_internal_value(scenario.kernel, [&](unsigned, unsigned, unsigned) { internal_values_.push_back(0); });
}

void ModuleValues::read(std::uint32_t tick) {
  for (unsigned joint = 0; joint < rack_.size(); ++joint) {
    if (reference_.stands_in_for(joint)) {
      setpoints_[joint] = reference_.chain().setpoints()[joint];
      write_link_contacts(latched_contacts_, joint, reference_.contacts(joint));
    } else if (rack_.has_computed(joint, tick)) {
      setpoints_[joint] = rack_.record(joint).setpoint;
      write_link_contacts(latched_contacts_, joint, rack_.record(joint).flags);
    } else {
      write_link_contacts(latched_contacts_, joint, 0);
    }
  }
  std::array<std::size_t, max_joints> next_value{};  // by joint, in its record
  auto value = internal_values_.begin();
  for_each_internal_value(scenario_.kernel, [&](unsigned slot, unsigned joint, unsigned number) {
    const firmware::TickRecord& record = rack_.record(joint);
    if (reference_.stands_in_for(joint)) {
      *value = reference_.chain().kernel(joint).internal_value(slot, joint, number);
    } else if (rack_.has_computed(joint, tick) && next_value[joint] < record.value_count) {
      *value = record.internal_values[next_value[joint]++];
    }
    ++value;
  });
}

void ModuleValues::read_whatever() {
  for (unsigned joint = 0; joint < rack_.size(); ++joint) {
    const bool is_new = rack_.has_computed_anew(joint);
    setpoints_[joint] = is_new ? rack_.record(joint).setpoint : setpoints_[joint];
    write_link_contacts(latched_contacts_, joint, is_new ? rack_.record(joint).flags : 0U);
  }
  std::array<std::size_t, max_joints> next_value{};  // by joint, in its record
  auto value = internal_values_.begin();
  for_each_internal_value(scenario_.kernel, [&](unsigned, unsigned joint, unsigned) {
    const firmware::TickRecord& record = rack_.record(joint);
    if (rack_.has_computed_anew(joint) && next_value[joint] < record.value_count) {
      *value = record.internal_values[next_value[joint]++];
    }
    ++value;
  });
}

void ModuleValues::read_pulses(std::span<const PlantTicks::Reading> readings) {
  pulses_.clear();
  for (const PlantTicks::Reading& reading : readings) {
    if (reading.pulse && !reference_.has_failed(reading.joint)) {
      pulses_.push_back({reading.time_us, reading.joint, *reading.pulse});
    }
  }
}

}  // namespace proleg::sim
