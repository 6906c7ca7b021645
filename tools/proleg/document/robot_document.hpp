#pragma once

// The parameters of a robot, and documents of the page (docs/page-interface.md) that describe a robot and its
// parameters.

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// A parameter of one joint.
struct ParameterPlace {
  std::uint8_t slot;
  std::uint8_t joint;   ///< in kernel order
  std::uint8_t number;  ///< in the declaration

  friend bool operator==(const ParameterPlace&, const ParameterPlace&) = default;
};

/// Place of a setting, which must be no internal value.
[[nodiscard]] inline ParameterPlace place_of(const Setting& setting) {
  return {setting.slot, setting.joint, setting.number};
}
[[nodiscard]] inline Setting setting_of(const ParameterPlace& place, std::int32_t value) {
  return {place.slot, place.joint, place.number, false, value};
}

/// The parameters of a robot that moves. Each has three raw values (shared/fixed/unit.hpp): that of the file, the one
/// last wanted, and the one that the joint's kernel uses.
class ParameterTable {
 public:
  struct Values {
    std::int32_t file = 0;
    std::int32_t wanted = 0;
    std::int32_t confirmed = 0;
    std::uint32_t tick = 0;  ///< tick from which the confirmed value holds
  };

  /// file: the scenario of the files. start: this scenario with the start values of a new run.
  ParameterTable(const sim::Scenario& file, const sim::Scenario& start);

  [[nodiscard]] const Values& at(const ParameterPlace& place) const { return values_[position(place)]; }
  void want(const ParameterPlace& place, std::int32_t value) { values_[position(place)].wanted = value; }
  void confirm(const ParameterPlace& place, std::int32_t value, std::uint32_t tick);
  /// Begins a new run: at its tick 0 each joint uses the wanted values.
  void begin_run();
  /// Makes the values of the file the wanted ones.
  void want_file_values();
  /// Sets the scenario of files that have changed.
  void set_file(const sim::Scenario& file);

  /// All parameters of all joints, in the order of slot, parameter, joint.
  [[nodiscard]] const std::vector<ParameterPlace>& places() const { return places_; }

 private:
  [[nodiscard]] std::size_t position(const ParameterPlace& place) const;

  std::size_t joints_;
  std::vector<ParameterPlace> places_;
  std::vector<Values> values_;
};

/// A vector as [x, y, z].
[[nodiscard]] nlohmann::json vector_json(const Eigen::Vector3d& vector);
/// A pose as [x, y, z, qw, qx, qy, qz].
[[nodiscard]] nlohmann::json pose_json(const sim::Pose& pose);

/// The meshes of the document `robot`, in its order.
using RobotMeshes = std::vector<std::shared_ptr<const sim::TriangleMesh>>;
[[nodiscard]] RobotMeshes robot_meshes(const sim::Scenario& scenario);
/// Whether the documents of both are the same.
[[nodiscard]] bool are_same(const RobotMeshes& meshes, const RobotMeshes& others);
[[nodiscard]] nlohmann::json meshes_json(const RobotMeshes& meshes);

/// The document `robot`. kind: "simulation", "bus" or "recording". Without its meshes, its `meshes` are empty.
enum class MeshesInDocument : std::uint8_t { yes, no };
[[nodiscard]] nlohmann::json robot_document(const sim::Scenario& scenario, std::string_view kind,
                                            MeshesInDocument meshes = MeshesInDocument::yes);

/// A parameter as its declaration has it: name, unit, range, default, help. Raw values.
[[nodiscard]] nlohmann::json parameter_declaration_json(const Parameter& parameter);

/// The document `parameters`.
[[nodiscard]] nlohmann::json parameters_document(const sim::Scenario& scenario, const ParameterTable& table);

}  // namespace proleg::tools
