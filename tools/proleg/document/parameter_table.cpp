#include "tools/proleg/document/parameter_table.hpp"

#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::tools {

ParameterTable::ParameterTable(const sim::Scenario& file, const sim::Scenario& start)
    : joints_(file.kernel.joint_count), values_(max_slots * max_parameters * joints_) {
  for (const unsigned slot : sim::used_slots(file)) {
    const Slot& used = file.kernel.slots[slot];
    const std::size_t parameters = used.algorithm->declaration().parameters.size();
    for (unsigned number = 0; number < parameters; ++number) {
      for (unsigned joint = 0; joint < joints_; ++joint) {
        if (!used.group.contains(joint)) {
          continue;
        }
        const ParameterPlace place{static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(joint),
                                   static_cast<std::uint8_t>(number)};
        places_.push_back(place);
        const std::int32_t value = sim::start_value(start, slot, joint, number);
        values_[position(place)] = {0, value, value, 0};
      }
    }
  }
  set_file(file);
}

void ParameterTable::confirm(const ParameterPlace& place, std::int32_t value, std::uint32_t tick) {
  Values& values = values_[position(place)];
  values.confirmed = value;
  values.tick = tick;
}

void ParameterTable::begin_run() {
  for (Values& values : values_) {
    values.confirmed = values.wanted;
    values.tick = 0;
  }
}

void ParameterTable::want_file_values() {
  for (Values& values : values_) {
    values.wanted = values.file;
  }
}

void ParameterTable::set_file(const sim::Scenario& file) {
  for (const ParameterPlace& place : places_) {
    values_[position(place)].file = sim::start_value(file, place.slot, place.joint, place.number);
  }
}

std::size_t ParameterTable::position(const ParameterPlace& place) const {
  return (std::size_t{place.slot} * max_parameters + place.number) * joints_ + place.joint;
}

}  // namespace proleg::tools
