#pragma once

#include <vector>

#include "sim/reduced/spatial_form.hpp"

namespace proleg::sim::reduced {

/// All that a SpatialBatch needs to know of a chain.
struct SpatialModel {
  // Equal in all chains of a batch.
  std::vector<SpatialLinkForm> links;
  std::vector<SpatialJointForm> joints;
  std::vector<BoxForm> boxes;
  FloorForm floor;
  bool self_collision = false;
  double step_s = 0.0;

  // Of this chain.
  std::vector<double> masses;                    ///< kg, by link
  std::vector<double> inertias;                  ///< kg m^2, six by link, as in SpatialMemory
  std::vector<double> friction;                  ///< by box, with the floor
  Point3 gravity;                                ///< m/s^2
  Point3 first_link;                             ///< its centre of mass at the start
  double orientation[4] = {1.0, 0.0, 0.0, 0.0};  ///< of the robot at the start: w, x, y, z

  /// Whether chains may share a batch.
  [[nodiscard]] bool has_form_of(const SpatialModel& other) const {
    return links == other.links && joints == other.joints && boxes == other.boxes && floor == other.floor &&
           self_collision == other.self_collision && step_s == other.step_s;
  }
};

}  // namespace proleg::sim::reduced
