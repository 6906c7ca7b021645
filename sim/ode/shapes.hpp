#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "sim/ode/engine_mesh.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// Data of a shape of the engine for collisions.
struct ShapeData {
  int link = 0;  ///< number of the link, of_environment or of_moving_object
  std::optional<double> friction;
  std::optional<double> friction_across;
  bool is_mesh = false;
};
inline constexpr int of_environment = -1;
inline constexpr int of_moving_object = -2;

[[nodiscard]] inline const ShapeData& data_of(dGeomID shape) {
  return *static_cast<const ShapeData*>(dGeomGetData(shape));
}

/// The shapes of a world, which the engine makes of the model's geometries.
class Shapes {
 public:
  /// Must be called first. count: number of all shapes to come. The engine keeps pointers to their data.
  void reserve(std::size_t count) { data_.reserve(count); }
  /// owner: the number of a link, of_environment or of_moving_object.
  dGeomID add(dSpaceID space, const Geometry& geometry, int owner);

 private:
  std::map<const TriangleMesh*, EngineMesh> meshes_;
  std::vector<ShapeData> data_;
};

inline void to_quaternion(const Eigen::Quaterniond& orientation, dQuaternion out) {
  out[0] = orientation.w();
  out[1] = orientation.x();
  out[2] = orientation.y();
  out[3] = orientation.z();
}

/// The orientation of the engine's shape for a geometry with this orientation.
[[nodiscard]] Eigen::Quaterniond engine_orientation(const Geometry& geometry, const Eigen::Quaterniond& orientation);

}  // namespace proleg::sim
