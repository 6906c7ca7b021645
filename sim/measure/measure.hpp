#pragma once

// The measures of a run, declared once. `proleg simulate`, fitness functions, the optimiser's store and
// docs/gait-measures.md take names, units and meaning from here.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::sim {

enum class Measure : std::uint8_t {
  distance,
  speed,
  sideways_speed,
  heading,
  yaw_rate,
  mechanical_energy,
  electrical_energy,
  cost_of_transport,
  electrical_cost_of_transport,
  specific_resistance,
  smoothness,
  stability_margin,
  height,
  slip,
  duty_factor,
  froude_number,
  stride_length,
  stride_frequency,
  tracking_error,
  max_tracking_error,
  at_speed_limit,
  at_torque_limit,
  largest_acceleration,
  mean_current,
  potential_energy,
  kinetic_energy,
  elastic_energy,
  wave_count,
  predicted_distance,
  lifted_links,
};
inline constexpr std::size_t measure_count = 30;

struct MeasureDeclaration {
  Measure measure;
  std::string_view name;  ///< name in files and JSON
  std::string_view unit;  ///< "" if dimensionless
  bool higher_is_better;
  bool may_be_negative;
  std::string_view help;
};

/// The declarations of all measures, in the order of the enumeration.
[[nodiscard]] std::span<const MeasureDeclaration, measure_count> measures();
[[nodiscard]] const MeasureDeclaration& declaration_of(Measure measure);
[[nodiscard]] std::optional<Measure> find_measure(std::string_view name);
/// The names that find_measure() accepts, for messages.
[[nodiscard]] std::vector<std::string> measure_names();

/// A value of each measure; NaN if the run does not define it (the cost of transport of a robot that does not move, the
/// stride length of a gait without strides).
class MeasureValues {
 public:
  MeasureValues() { values_.fill(std::numeric_limits<double>::quiet_NaN()); }
  [[nodiscard]] double& operator[](Measure measure) { return values_[static_cast<std::size_t>(measure)]; }
  [[nodiscard]] double operator[](Measure measure) const { return values_[static_cast<std::size_t>(measure)]; }
  [[nodiscard]] std::span<double, measure_count> all() { return values_; }
  [[nodiscard]] std::span<const double, measure_count> all() const { return values_; }

 private:
  std::array<double, measure_count> values_;
};

}  // namespace proleg::sim
