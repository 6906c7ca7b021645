#include "sim/mujoco/box_collision.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

namespace proleg::sim::mujoco {
namespace {

mjfCollision collide_boxes = nullptr;

/// How far a box reaches from its centre along a direction.
mjtNum reach(const mjModel* model, const mjData* data, int box, const mjtNum* direction) {
  const mjtNum* const rotation = data->geom_xmat + 9 * box;  // by rows
  mjtNum sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const mjtNum along =
        rotation[axis] * direction[0] + rotation[3 + axis] * direction[1] + rotation[6 + axis] * direction[2];
    sum += model->geom_size[3 * box + axis] * std::abs(along);
  }
  return sum;
}

/// Along the normal of a contact two boxes overlap by at least the depth of the contact.
int collide(const mjModel* model, const mjData* data, mjContact* contacts, int a, int b, mjtNum margin) {
  constexpr mjtNum tolerance = 1e-3;  // m
  const int count = collide_boxes(model, data, contacts, a, b, margin);
  const mjContact* const end = std::remove_if(contacts, contacts + count, [&](const mjContact& contact) {
    const mjtNum* const normal = contact.frame;
    mjtNum distance = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      distance += (data->geom_xpos[3 * b + axis] - data->geom_xpos[3 * a + axis]) * normal[axis];
    }
    const mjtNum overlap = reach(model, data, a, normal) + reach(model, data, b, normal) - std::abs(distance);
    return -contact.dist > overlap + tolerance;
  });
  return static_cast<int>(end - contacts);
}

}  // namespace

void mend_box_collision() {
  if (collide_boxes == nullptr) {
    collide_boxes = mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX];
    mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX] = collide;
  }
}

}  // namespace proleg::sim::mujoco
