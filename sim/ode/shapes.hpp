#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "sim/robot/robot_model.hpp"
#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

/// A mesh in the form of the engine, which keeps pointers into it: it must not move and must outlive its shapes.
class EngineMesh {
 public:
  explicit EngineMesh(const TriangleMesh& mesh) : data_(dGeomTriMeshDataCreate()) {
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
      vertices_.insert(vertices_.end(), vertex.data(), vertex.data() + 3);
    }
    for (const auto& triangle : mesh.triangles) {
      indices_.insert(indices_.end(), triangle.begin(), triangle.end());
    }
    dGeomTriMeshDataBuildDouble(data_.get(), vertices_.data(), 3 * sizeof(double),
                                static_cast<int>(mesh.vertices.size()), indices_.data(),
                                static_cast<int>(indices_.size()), 3 * sizeof(dTriIndex));
    // Contacts of a cylinder with a mesh need the angles between its triangles.
    dGeomTriMeshDataPreprocess2(data_.get(), 1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, nullptr);
  }
  EngineMesh(const EngineMesh&) = delete;
  EngineMesh& operator=(const EngineMesh&) = delete;

  [[nodiscard]] dGeomID make_shape(dSpaceID space) const {
    return dCreateTriMesh(space, data_.get(), nullptr, nullptr, nullptr);
  }

 private:
  struct Destroy {
    void operator()(dxTriMeshData* data) const { dGeomTriMeshDataDestroy(data); }
  };

  std::vector<double> vertices_;
  std::vector<dTriIndex> indices_;
  std::unique_ptr<dxTriMeshData, Destroy> data_;
};

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
