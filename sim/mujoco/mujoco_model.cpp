#include "sim/mujoco/mujoco_model.hpp"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <mutex>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/physics/physics_error.hpp"

namespace proleg::sim::mujoco {
namespace {

mjfCollision collide_boxes = nullptr;

/// Distance that a box reaches from its centre along a direction.
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

/// Finds the contacts of two boxes. Along the normal of a contact two boxes overlap by at least the contact's depth.
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

/// Replaces MuJoCo's function for two boxes that touch, for all models of this process: it drops contacts that no
/// position of the boxes allows. Where faces just meet, MuJoCo 2.2.2 sometimes also reports a contact that is as deep
/// as a whole box (its issue 3476), and throws a robot into the air.
void mend_box_collision() {
  if (collide_boxes == nullptr) {
    collide_boxes = mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX];
    mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX] = collide;
  }
}

// MuJoCo ends the process when this returns; an exception is the only way out.
[[noreturn]] void raise_error(const char* text) { throw PhysicsError("MuJoCo reports: " + one_line(text)); }

/// Ignores a warning. MuJoCo's own function writes a file where the program was started. MujocoWorld reads warnings
/// from MuJoCo's data.
void ignore_warning(const char* /*text*/) {}

}  // namespace

Model compile_mjcf(const std::string& text, const std::string& file) {
  static std::mutex mutex;  // MuJoCo keeps the last model that it compiled
  const std::lock_guard lock(mutex);
  mju_user_error = raise_error;
  mju_user_warning = ignore_warning;
  mend_box_collision();
  constexpr const char* name = "robot.xml";
  const auto files = std::make_unique<mjVFS>();  // it has a size of megabytes
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(text.size())) != 0) {
    throw PhysicsError("MuJoCo takes no model of " + std::to_string(text.size()) + " bytes");
  }
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], text.data(), text.size());
  std::array<char, 1000> reason{};
  Model model(mj_loadXML(name, files.get(), reason.data(), static_cast<int>(reason.size())));
  mj_deleteVFS(files.get());
  if (model == nullptr) {
    throw InputError(file, 0, "what MuJoCo refuses: " + one_line(reason.data()),
                     "a robot and an environment that it has (or --engine ode)");
  }
  return model;
}

}  // namespace proleg::sim::mujoco
