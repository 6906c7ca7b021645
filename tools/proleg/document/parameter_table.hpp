#pragma once

#include <cstdint>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// A parameter of one joint.
struct ParameterPlace {
  std::uint8_t slot;
  std::uint8_t joint;  ///< kernel order
  std::uint8_t index;  ///< in the declaration

  [[nodiscard]] bool operator==(const ParameterPlace& other) const {
    return slot == other.slot && joint == other.joint && index == other.index;
  }
};

/// Of a setting that is no internal value.
[[nodiscard]] inline ParameterPlace place_of(const sim::Setting& setting) {
  return {setting.slot, setting.joint, setting.index};
}
[[nodiscard]] inline sim::Setting setting_of(const ParameterPlace& place, std::int32_t value) {
  return {place.slot, place.joint, place.index, false, value};
}

/// The parameters of a robot that moves. Three values of each are told apart: of the file, as last asked for, and as
/// the joint's kernel uses it. Raw values (shared/fixed/unit.hpp).
class ParameterTable {
 public:
  struct Values {
    std::int32_t file = 0;
    std::int32_t wanted = 0;
    std::int32_t confirmed = 0;
    std::uint32_t tick = 0;  ///< from which the confirmed value holds
  };

  /// file: as the files have it. start: the same with other start values: those of a new run.
  ParameterTable(const sim::Scenario& file, const sim::Scenario& start);

  [[nodiscard]] const Values& at(const ParameterPlace& place) const { return values_[position(place)]; }
  void want(const ParameterPlace& place, std::int32_t value) { values_[position(place)].wanted = value; }
  void confirm(const ParameterPlace& place, std::int32_t value, std::uint32_t tick);
  /// At tick 0 of a new run each joint uses what is wanted.
  void begin_run();
  /// What is wanted is again what the file says.
  void want_file_values();
  /// The files have changed.
  void set_file(const sim::Scenario& file);

  /// Every parameter of every joint, in the order of slot, parameter, joint.
  [[nodiscard]] const std::vector<ParameterPlace>& places() const { return places_; }

 private:
  [[nodiscard]] std::size_t position(const ParameterPlace& place) const;

  std::size_t joints_;
  std::vector<ParameterPlace> places_;
  std::vector<Values> values_;
};

}  // namespace proleg::tools
