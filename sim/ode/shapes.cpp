#include "sim/ode/shapes.hpp"

namespace proleg::sim {

dGeomID Shapes::add(dSpaceID space, const Geometry& geometry, int owner) {
  dGeomID shape = nullptr;
  switch (geometry.shape) {
    case Shape::box:
      shape = dCreateBox(space, 2 * geometry.extents.x(), 2 * geometry.extents.y(), 2 * geometry.extents.z());
      break;
    case Shape::sphere:
      shape = dCreateSphere(space, geometry.extents.x());
      break;
    case Shape::cylinder:
      shape = dCreateCylinder(space, geometry.extents.x(), 2 * geometry.extents.y());
      break;
    case Shape::hull:
    case Shape::surface:
    case Shape::height_field:
      shape = meshes_.try_emplace(geometry.mesh.get(), *geometry.mesh).first->second.make_shape(space);
      break;
  }
  data_.push_back({owner, geometry.friction, geometry.friction_across, geometry.mesh != nullptr});
  dGeomSetData(shape, &data_.back());
  return shape;
}

/// Orientation for the engine, whose cylinders lie along z; those of the model lie along y.
Eigen::Quaterniond engine_orientation(const Geometry& geometry, const Eigen::Quaterniond& orientation) {
  if (geometry.shape == Shape::cylinder) {
    return orientation * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
  }
  return orientation;
}

}  // namespace proleg::sim
