#include "sim/data_file/module_output.hpp"

#include <algorithm>

#include "shared/gait/registry.hpp"

namespace proleg::sim {
namespace {

bool has_recorded_values(const Declaration& declaration, const Recording& recording, std::uint32_t slot) {
  for (const RecordedInternalValue& value : recording.internal_values()) {
    if (value.slot == slot && (value.number >= declaration.internal_values.size() ||
                               declaration.internal_values[value.number].name != value.name)) {
      return false;
    }
  }
  const auto recorded = std::ranges::count_if(
      recording.internal_values(), [slot](const RecordedInternalValue& value) { return value.slot == slot; });
  const auto group = std::ranges::find(recording.slots(), slot, &RecordedSlot::slot);
  const auto joints = std::ranges::count(group->joint_group, true);
  return static_cast<std::size_t>(recorded) == static_cast<std::size_t>(joints) * declaration.internal_values.size();
}

}  // namespace

ModuleOutput::ModuleOutput(const Recording& recording, const RecordedSlot& slot) : recording_(recording), slot_(slot) {
  const ActuationModule* algorithm = find_algorithm(slot.algorithm);
  if (algorithm == nullptr || !has_recorded_values(algorithm->declaration(), recording, slot.slot)) {
    return;
  }
  algorithm_ = algorithm;
  for (const RecordedSetting& setting : recording.parameters()) {
    if (setting.slot == slot.slot && find_parameter(algorithm->declaration(), setting.name) >= 0) {
      settings_.push_back(setting);
    }
  }
  std::ranges::stable_sort(settings_, [](const RecordedSetting& a, const RecordedSetting& b) {
    return (a.commit ? a.tick + 1 : 0) < (b.commit ? b.tick + 1 : 0);
  });
  JointTuning defaults;
  for (std::size_t i = 0; i < algorithm->declaration().parameters.size(); ++i) {
    defaults.parameters[i] = algorithm->declaration().parameters[i].default_value;
  }
  tunings_.assign(recording.joints().size(), defaults);
  while (next_setting_ < settings_.size() && !settings_[next_setting_].commit) {
    apply(settings_[next_setting_++]);
  }
  for (std::uint32_t joint = 0; joint < tunings_.size(); ++joint) {
    derive(joint);
  }
}

void ModuleOutput::apply(const RecordedSetting& setting) {
  const int parameter = find_parameter(algorithm_->declaration(), setting.name);
  tunings_[setting.joint].parameters[static_cast<std::size_t>(parameter)] = setting.raw;
}

void ModuleOutput::derive(std::uint32_t joint) {
  JointContext context{static_cast<std::uint8_t>(joint), static_cast<std::uint8_t>(tunings_.size()), JointMask(),
                       recording_.tick_period_us()};
  for (std::uint32_t member = 0; member < tunings_.size(); ++member) {
    if (slot_.joint_group[member]) {
      context.group.insert(member);
    }
  }
  algorithm_->derive(context, tunings_[joint].parameters.data(), tunings_[joint].derived.data());
}

std::int32_t ModuleOutput::at(std::uint32_t tick, std::uint32_t joint, const std::int32_t* state) {
  while (next_setting_ < settings_.size() && settings_[next_setting_].tick <= tick) {
    apply(settings_[next_setting_]);
    derive(settings_[next_setting_++].joint);
  }
  return algorithm_->output({tunings_[joint].parameters.data(), tunings_[joint].derived.data()}, state);
}

}  // namespace proleg::sim
