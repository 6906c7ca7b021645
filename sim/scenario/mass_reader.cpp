#include "sim/scenario/mass_reader.hpp"

#include <optional>

#include <Eigen/Eigenvalues>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/geometry_reader.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr Range inertias{-1e12, 1e12, "kg m^2"};

/// The mass from <total>, or from <density> and a volume.
double read_total(const XmlElement& element, double volume) {
  const std::optional<XmlElement> total = element.child("total");
  const std::optional<XmlElement> density = element.child("density");
  if (total.has_value() == density.has_value()) {
    element.refuse((total ? "both <total> and <density> in " : "neither <total> nor <density> in ") + element.label(),
                   "one of them");
  }
  if (total) {
    return read_number(*total, masses);
  }
  const double mass = read_number(*density, densities) * volume;
  if (mass < masses.min || mass > masses.max) {
    density->refuse("a density that makes " + number_text(mass) + " kg",
                    "a mass from " + number_text(masses.min) + " to " + number_text(masses.max) + " kg");
  }
  return mass;
}

SolidProperties required_solids(const XmlElement& element, const std::vector<Geometry>& geometries,
                                const std::string& what) {
  if (geometries.empty()) {
    element.refuse(element.label() + " of a body without <Geom>", what);
  }
  return solid_properties(geometries);
}

MassProperties read_custom(const XmlElement& element, const std::vector<Geometry>& geometries) {
  element.allow({"type"}, {"total", "com", "inertia"});
  MassProperties result;
  result.mass = read_number(element.required_child("total"), masses);
  const std::optional<XmlElement> com = element.child("com");
  const std::optional<XmlElement> inertia = element.child("inertia");
  if (com) {
    result.center = read_vector(*com, coordinates);
  } else {
    result.center = required_solids(element, geometries, "<com> in the <Mass>").center;
  }
  if (inertia) {
    const std::vector<double> numbers = read_numbers(*inertia, 9, inertias);
    result.inertia = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  } else {
    const SolidProperties solids = required_solids(element, geometries, "<inertia> in the <Mass>");
    result.inertia = solids.inertia * (result.mass / solids.volume);
  }
  return result;
}

MassProperties read_box(const XmlElement& element) {
  element.allow({"type"}, {"total", "density", "extents", "com"});
  MassProperties result;
  const Eigen::Vector3d half_sides = read_vector(element.required_child("extents"), lengths);
  result.mass = read_total(element, 8.0 * half_sides.prod());
  if (const auto com = element.child("com")) {
    result.center = read_vector(*com, coordinates);
  }
  result.inertia = result.mass * box_inertia(half_sides);
  return result;
}

MassProperties read_mimic(const XmlElement& element, const std::vector<Geometry>& geometries) {
  element.allow({"type"}, {"total", "density"});
  const SolidProperties solids = required_solids(element, geometries, "another type, or a <Geom>");
  const double mass = read_total(element, solids.volume);
  return {mass, solids.center, solids.inertia * (mass / solids.volume)};
}

/// False also for a matrix that is nearly singular: rounding would make it singular in the engine.
bool is_positive_definite(const Eigen::Matrix3d& inertia) {
  constexpr double tolerance = 1e-9;
  const double size = inertia.cwiseAbs().maxCoeff();
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() > tolerance * size) {
    return false;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() > tolerance * size;
}

}  // namespace

MassProperties read_mass(const XmlElement& element, const std::vector<Geometry>& geometries) {
  const std::string type = lower_case(element.required_attribute("type"));
  MassProperties result;
  if (type == "custom") {
    result = read_custom(element, geometries);
  } else if (type == "box") {
    result = read_box(element);
  } else if (type == "mimicgeom") {
    result = read_mimic(element, geometries);
  } else {
    element.refuse("type " + in_quotes(type) + " in " + element.label(), "'custom', 'box' or 'mimicgeom'");
  }
  if (!is_positive_definite(result.inertia)) {
    element.refuse("an inertia that is not positive definite in " + element.label(),
                   "a symmetric matrix with eigenvalues above 0, the smallest above 1e-9 of the largest");
  }
  result.inertia = (result.inertia + result.inertia.transpose().eval()) / 2.0;
  return result;
}

}  // namespace proleg::sim
