#pragma once

#include <ode/ode.h>

#include <memory>
#include <vector>

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

}  // namespace proleg::sim
