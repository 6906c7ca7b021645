#pragma once

#include <vector>

#include "sim/reduced/chain_form.hpp"

namespace proleg::sim::reduced {

/// All that a ChainBatch needs to know of a chain.
struct ChainModel {
  // Equal in all chains of a batch.
  std::vector<LinkForm> links;
  std::vector<JointForm> joints;
  std::vector<ShapeForm> shapes;
  std::vector<Rectangle> terrain;
  bool self_collision = false;
  double step_s = 0.0;

  // Of this chain.
  std::vector<double> masses;            ///< kg, by link
  std::vector<double> inertias;          ///< kg m^2, by link, about its centre of mass
  std::vector<double> terrain_friction;  ///< by shape, then by solid
  std::vector<double> self_friction;     ///< by shape, then by shape
  Point gravity;                         ///< m/s^2
  Point first_link;                      ///< its centre of mass at the start

  /// Whether chains may share a batch.
  [[nodiscard]] bool has_form_of(const ChainModel& other) const {
    return links == other.links && joints == other.joints && shapes == other.shapes && terrain == other.terrain &&
           self_collision == other.self_collision && step_s == other.step_s;
  }
};

}  // namespace proleg::sim::reduced
