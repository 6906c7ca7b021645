#include "sim/hardware_loop/reference_gait.hpp"

#include <array>
#include <cstddef>

#include "sim/record/recorded_run.hpp"

namespace proleg::sim {

ReferenceGait::ReferenceGait(const Scenario& scenario, const Losses* losses)
    : gait_(scenario),
      touch_(scenario.robot.joints.size()),
      failed_(scenario.robot.joints.size()),
      readings_(scenario.robot.joints.size()) {
  gait_.chain().set_losses(losses);
}

void ReferenceGait::follow(unsigned joint, const ModuleTick& module, HardwareReport& report) {
  if (chain().is_running(joint)) {
    if (module.has_restarted || stands_in_for(joint)) {
      stop(joint, report);
    } else if (!module.has_computed) {
      fail(joint, report);
      if (!module.has_sent) {
        stop(joint, report);
      }
    }
  } else if (module.has_computed || module.has_sent) {
    failed_[joint] = false;
    gait_.chain().join(joint);
    report.restart_events.push_back({joint, true});
    if (!module.has_computed) {
      fail(joint, report);
    }
  }
}

void ReferenceGait::fail(unsigned joint, HardwareReport& report) {
  failed_[joint] = true;
  report.failures.push_back({gait_.tick(), joint});
  report.add({Difference::Kind::missed_tick, gait_.tick(), joint, std::nullopt, std::nullopt});
}

void ReferenceGait::stop(unsigned joint, HardwareReport& report) {
  gait_.chain().stop(joint);
  touch_.reset(joint);
  report.restart_events.push_back({joint, false});
}

void ReferenceGait::set_current(unsigned joint, std::uint16_t current_ma) {
  readings_[joint] = {};
  readings_[joint].present = JointReadings::servo_current;
  readings_[joint].current_ma = current_ma;
  readings_[joint] = readings_[joint].only(chain().kernel(joint).needed_readings(joint));
  gait_.chain().set_readings(joint, readings_[joint]);
}

const Change* ReferenceGait::advance(std::span<const std::uint8_t> link_contacts, bool is_change_made) {
  if (gait_.due_change() && !is_change_made) {
    gait_.leave_out_change();
  }
  const Change* const change = gait_.apply_due_changes();
  for (unsigned joint = 0; joint < chain().joint_count(); ++joint) {
    if (chain().is_running(joint)) {
      touch_.sample(link_contacts, joint);
    }
  }
  gait_.advance(touch_.contacts());
  return change;
}

void ReferenceGait::compare(std::span<const std::int32_t> setpoints, std::span<const ServoPulse> pulses,
                            HardwareReport& report) {
  const auto add = [&report](const Difference& difference) { report.add(difference); };
  const std::uint32_t tick = gait_.tick() - 1;
  compare_setpoints(tick, setpoints, chain().setpoints(), add);
  expected_pulses_.assign(gait_.pulses().begin(), gait_.pulses().end());
  std::erase_if(expected_pulses_, [this](const ServoPulse& pulse) { return has_failed(pulse.joint); });
  compare_pulses(tick, pulses, expected_pulses_, add);
}

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
